// A deletion method and its buffers at work on a mesh, outside the triangulation class: any method, not production's alone.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "tin/removal/method.h"

namespace bench {

class Deletion {
 public:
  /// Throws std::runtime_error for an unknown name.
  explicit Deletion(const std::string& name) : method_(tin::removal::make_method(name)) {
    if (method_ == nullptr) throw std::runtime_error("unknown method " + name);
  }

  /// Removes `v`; counts if told where. False, and nothing done, when only collinear vertices would be left.
  bool remove(tin::mesh::Mesh& mesh, tin::mesh::VertexSlot v, tin::removal::Counters* counters = nullptr) {
    star_.gather(mesh, v);
    if (star_.leaves_a_line()) return false;
    star_.refill(mesh, counters == nullptr ? method_->fill(star_) : method_->fill(star_, *counters), fresh_);
    return true;
  }

  /// Of the last vertex removed.
  std::uint32_t degree() const { return star_.degree(); }

 private:
  std::unique_ptr<tin::removal::Method> method_;
  tin::removal::Star star_;
  std::vector<tin::mesh::TriangleSlot> fresh_;
};

}  // namespace bench
