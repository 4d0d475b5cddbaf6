// What the tests of the deletion methods share: all methods, and their answers as comparable triangles.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/mesh_view.h"
#include "tests/support/point_sets.h"
#include "tin/delaunay/triangulation.h"
#include "tin/mesh/validate.h"
#include "tin/removal/method.h"

namespace removal_tests {

/// "" when the mesh is valid, else what is broken.
inline std::string broken(const tin::mesh::Mesh& mesh) { return tin::mesh::validate(mesh).value_or(""); }

/// Ears as sorted triples of positions, each from its smallest on: equal means the same triangles.
inline std::vector<std::array<std::uint32_t, 3>> triples(std::span<const tin::removal::Ear> ears) {
  std::vector<std::array<std::uint32_t, 3>> out;
  for (const auto [previous, middle, next] : ears) {
    std::array<std::uint32_t, 3> t{previous, middle, next};
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    out.push_back(t);
  }
  std::sort(out.begin(), out.end());
  return out;
}

class RemovalTest : public testing::Test {
 protected:
  RemovalTest() {
    for (const auto& name : tin::removal::method_names()) methods_.push_back(tin::removal::make_method(name));
  }

  /// Fills the star of `v` by all methods, which must agree. The reference is the ear queue.
  void expect_all_agree(const tin::mesh::Mesh& mesh, tin::mesh::VertexSlot v) {
    star_.gather(mesh, v);
    if (star_.leaves_a_line()) return;
    const auto expected = triples(methods_.front()->fill(star_));
    for (const auto& method : methods_) ASSERT_EQ(triples(method->fill(star_)), expected) << method->name();
  }

  tin::mesh::VertexSlot vertex_at(const tin::delaunay::Triangulation& t, tin::exact::Point p) {
    const auto where = t.locate(p);
    EXPECT_EQ(where.kind, tin::delaunay::Location::Kind::kOnVertex);
    return where.vertex;
  }

  support::Random random_{support::seed()};
  testing::ScopedTrace trace_{__FILE__, __LINE__, "TINSMITH_SEED=" + std::to_string(support::seed())};
  std::vector<std::unique_ptr<tin::removal::Method>> methods_;
  tin::removal::Star star_;
};

}  // namespace removal_tests
