// Integer ids that are types of their own: a VertexSlot is no TriangleSlot and no int.
#pragma once

#include <compare>
#include <cstdint>
#include <functional>

namespace tin::base {

/// An integer that names something; `Tag` tells what. Costs what the integer costs.
template <class Tag, class Int>
class StrongId {
 public:
  constexpr StrongId() = default;
  constexpr explicit StrongId(Int value) : value_(value) {}

  constexpr Int value() const { return value_; }
  friend constexpr auto operator<=>(StrongId, StrongId) = default;

 private:
  Int value_ = 0;
};

}  // namespace tin::base

template <class Tag, class Int>
struct std::hash<tin::base::StrongId<Tag, Int>> {
  std::size_t operator()(tin::base::StrongId<Tag, Int> id) const noexcept { return std::hash<Int>{}(id.value()); }
};
