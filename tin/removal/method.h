// The deletion methods of the paper behind one interface, for those who compare them: tests and benchmarks.
//
//   const auto method = make_method("mixed:9");
//   Counters counters;
//   star.gather(mesh, v);
//   for (const Ear& ear : method->fill(star, counters)) ...
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tin/removal/counters.h"
#include "tin/removal/star.h"

namespace tin::removal {

class Method {
 public:
  virtual ~Method() = default;
  virtual std::string_view name() const = 0;
  /// The triangles that fill the hole: the same from every method. Valid until the next call.
  /// Requires: the star does not leave a line.
  virtual std::span<const Ear> fill(const Star& star) = 0;
  /// The same, counting.
  virtual std::span<const Ear> fill(const Star& star, Counters& counters) = 0;
};

/// "ear3", "ear3-update", "ear5", "flip", "mixed:5" to "mixed:11", "edge-completion", "chew", "production";
/// null for any other name.
std::unique_ptr<Method> make_method(std::string_view name);

/// The names of all of them.
std::vector<std::string> method_names();

}  // namespace tin::removal
