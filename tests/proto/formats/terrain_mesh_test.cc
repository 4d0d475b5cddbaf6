// Which vertices and triangles of a terrain a file gets.
#include <cmath>

#include "tests/proto/formats/parsed.h"
#include "tests/proto/formats/support.h"
#include "tin/query/void_triangles.h"

namespace tests::formats {
namespace {

using proto::formats::TerrainMesh;
using tin::base::Code;

double area(const ParsedMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const auto &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    EXPECT_GT(twice, 0);
    sum += twice / 2;
  }
  return sum;
}

TEST(TerrainMeshTest, TrianglesOverVoidsAreLeftOutUnlessTheVoidsAreFilled) {
  const Terrain terrain = drawn_terrain({"11111", "11.11", "11111"});
  // What lies between the four neighbours of the void cell is a diamond of two cells' area.
  EXPECT_NEAR(area(parse_obj(written(terrain, "obj"))), 8 * 100 - 200, 1e-6);
  EXPECT_NEAR(area(parse_obj(written(terrain, "obj", {.voids = proto::Voids::kFill}))), 8 * 100, 1e-6);
  const ParsedMesh land = parse_landxml(written(terrain, "landxml"));
  expect_mesh_of(land, terrain);
  EXPECT_EQ(land.hidden, 2U);
}

TEST(TerrainMeshTest, AVertexInAVoidMakesTheTrianglesAtItTerrain) {
  Terrain terrain = drawn_terrain({"11111", "11.11", "11111"});
  const auto centre = terrain.source_grid()->centre(2, 1);
  const auto added = terrain.apply(std::vector<tin::terrain::Edit>{tin::terrain::Insert{centre, 5}},
                                   tin::terrain::Duplicates::kReject);
  ASSERT_TRUE(added.ok());
  EXPECT_NEAR(area(parse_obj(written(terrain, "obj"))), 8 * 100, 1e-6);
}

/// However few vertices are left, each valid sample lies in a triangle that stays.
TEST(TerrainMeshTest, EveryValidSampleOfASimplifiedTerrainStaysCovered) {
  std::vector<std::string> rows(40, std::string(40, '1'));
  for (std::size_t row = 8; row < 30; ++row) {
    for (std::size_t column = 5; column < 35; ++column) {
      if ((row * 7 + column * 3) % 11 > 2) rows[row][column] = '.';
    }
  }
  Terrain terrain = drawn_terrain(rows);
  std::vector<tin::terrain::VertexId> gone;
  for (const auto& vertex : terrain.vertices_by_id()) {
    const bool corner = std::abs(vertex.at.x) % 390000 == 0 && std::abs(vertex.at.y) % 390000 == 0;
    if (!corner && vertex.id.value() % 5 != 0) gone.push_back(vertex.id);
  }
  const auto grid = terrain.shared_source_grid();
  terrain = terrain.without(gone);
  terrain.set_source_grid(grid);
  const ParsedMesh mesh = parse_obj(written(terrain, "obj"));
  ASSERT_GT(mesh.triangles.size(), 100U);
  EXPECT_LT(mesh.triangles.size(), terrain.triangle_count());
  for (std::int32_t row = 0; row < grid->height; ++row) {
    for (std::int32_t column = 0; column < grid->width; ++column) {
      if (!grid->is_valid(column, row)) continue;
      const double x = terrain.frame().x.world(grid->centre(column, row).x);
      const double y = terrain.frame().y.world(grid->centre(column, row).y);
      const bool covered = std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
        for (std::size_t i = 0; i < 3; ++i) {
          const auto &a = mesh.vertices[t[i]], &b = mesh.vertices[t[(i + 1) % 3]];
          if ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) < -1e-6) return false;
        }
        return true;
      });
      EXPECT_TRUE(covered) << column << ", " << row;
    }
  }
}

TEST(TerrainMeshTest, ABoxTakesTheTrianglesThatTouchItWithTheirVertices) {
  const Terrain terrain = random_terrain(2000);
  const proto::Bbox box{500000, 4099900, 500100, 4100000, {}, {}};
  const ParsedMesh part = parse_obj(written(terrain, "obj", {.box = box})),
                   whole = parse_obj(written(terrain, "obj"));
  const auto touching = [&box](const ParsedMesh& mesh) {
    std::size_t count = 0;
    for (const auto& t : mesh.triangles) {
      // Separating axes, by a walk over points: good enough to judge, since a border case has measure zero.
      bool touches = false;
      const auto &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
      constexpr int kSteps = 60;
      for (int i = 0; i <= kSteps && !touches; ++i) {
        for (int j = 0; i + j <= kSteps && !touches; ++j) {
          const double u = double(i) / kSteps, v = double(j) / kSteps, w = 1 - u - v;
          const double x = u * a[0] + v * b[0] + w * c[0], y = u * a[1] + v * b[1] + w * c[1];
          touches = x >= box.min_x && x <= box.max_x && y >= box.min_y && y <= box.max_y;
        }
      }
      count += touches ? 1 : 0;
    }
    return count;
  };
  ASSERT_GT(part.triangles.size(), 20U);
  EXPECT_LT(part.triangles.size(), whole.triangles.size() / 2);
  EXPECT_LE(touching(whole), part.triangles.size());      // the walk may miss a grazing one
  EXPECT_GE(touching(part) + 12, part.triangles.size());  // and all that came do touch
  std::vector<bool> used(part.vertices.size());
  for (const auto& t : part.triangles) {
    for (const auto corner : t) used.at(corner) = true;
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
}

TEST(TerrainMeshTest, ABoxWithoutAnythingIsAnError) {
  const Terrain terrain = random_terrain(10);
  EXPECT_EQ(TerrainMesh::create(terrain, {.box = proto::Bbox{0, 0, 1, 1, {}, {}}}).error().where,
            "query:bbox");
  EXPECT_EQ(TerrainMesh::create(Terrain(projected_frame()), {}).error().code, Code::kInvalidValue);
}

TEST(TerrainMeshTest, AnotherCrsHasConvertedPositionsAndNoLattice) {
  const Terrain terrain = random_terrain(3000);
  const auto convert = [](std::span<double> x, std::span<double> y, std::vector<std::uint8_t>&) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = 2 * x[i], y[i] = y[i] + 1;
    return true;
  };
  auto mesh = TerrainMesh::create(terrain, {.convert = convert, .crs = "EPSG:1"});
  ASSERT_TRUE(mesh.ok());
  EXPECT_FALSE((*mesh)->head().frame);
  EXPECT_EQ((*mesh)->head().crs, "EPSG:1");
  EXPECT_EQ((*mesh)->head().vertices, 3000U);
  EXPECT_EQ((*mesh)->head().triangles, terrain.triangle_count());
  const auto vertices = terrain.vertices_by_id();
  proto::formats::MeshVertex vertex;
  for (const auto& expected : vertices) {
    ASSERT_TRUE((*mesh)->next_vertex(vertex));
    EXPECT_EQ(vertex.id, expected.id);
    EXPECT_EQ(vertex.at.x, 2 * terrain.frame().x.world(expected.at.x));
    EXPECT_EQ(vertex.at.y, 1 + terrain.frame().y.world(expected.at.y));
    EXPECT_GE(vertex.at.x, (*mesh)->head().low.x);
    EXPECT_LE(vertex.at.y, (*mesh)->head().high.y);
  }
  EXPECT_FALSE((*mesh)->next_vertex(vertex));
}

TEST(TerrainMeshTest, AVertexWithoutAPositionThereIsAnError) {
  const Terrain terrain = random_terrain(3000);
  const auto convert = [](std::span<double> x, std::span<double>, std::vector<std::uint8_t>& ok) {
    ok[x.size() / 2] = 0;
    return false;
  };
  EXPECT_EQ(TerrainMesh::create(terrain, {.convert = convert}).error().where, "query:crs");
}

TEST(TerrainMeshTest, AnImpatientClientEndsThePreparation) {
  const Terrain terrain = random_terrain(3000);
  int asked = 0;
  const auto check = [&asked]() -> tin::base::Result<void> {
    if (++asked < 2) return {};
    return tin::base::error(Code::kCancelled, "enough");
  };
  EXPECT_EQ(TerrainMesh::create(terrain, {.check = check}).error().code, Code::kCancelled);
}

}  // namespace
}  // namespace tests::formats
