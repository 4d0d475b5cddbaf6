#include <gtest/gtest.h>

#include "tin/mesh/mesh.h"

namespace {

TEST(GrowthTest, AMeshThatGrowsOneByOneWastesNoMoreThanAQuarter) {
  constexpr std::uint32_t kBytes = 8 + 4 + 2 * 24;  // per vertex: position, star, two triangles
  tin::mesh::Mesh mesh;
  for (std::uint32_t i = 1; i <= 200'000; ++i) {
    mesh.add_vertex({static_cast<std::int32_t>(i), 0});
    mesh.claim_triangle(tin::mesh::TriangleSlot(0));
    mesh.claim_triangle(tin::mesh::TriangleSlot(0));
    if (i % 1000 != 0) continue;
    ASSERT_LE(mesh.bytes(), std::size_t{i} * kBytes * 5 / 4 + 1000);
  }
}

}  // namespace
