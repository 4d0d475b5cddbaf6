#include "tests/proto/formats/support.h"

#include <cstdlib>
#include <random>
#include <set>

namespace tests::formats {

using tin::terrain::Duplicates;
using tin::terrain::Placement;

tin::frame::Frame projected_frame() {
  tin::frame::Frame frame;
  frame.crs = "EPSG:32632";
  frame.x = {500000.125, 1, 1000};
  frame.y = {4100000.1, 0.3, 300};
  frame.vertical_unit = "foot";
  frame.vertical_unit_m = 0.3048;
  return frame;
}

Terrain random_terrain(std::size_t vertices, const tin::frame::Frame& frame) {
  const char* const given = std::getenv("TINSMITH_SEED");
  const unsigned seed = given == nullptr ? 20021128 : static_cast<unsigned>(std::strtoul(given, nullptr, 10));
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(seed));
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::int32_t> across(-400000, 400000);
  std::uniform_real_distribution<double> up(-50, 3000);
  std::vector<Placement> placements;
  for (std::size_t i = 0; i < vertices; ++i)
    placements.push_back({{across(random), across(random)}, up(random)});
  auto terrain = Terrain::build(frame, placements, Duplicates::kKeep);
  EXPECT_TRUE(terrain.ok());
  return *std::move(terrain);
}

Terrain drawn_terrain(const std::vector<std::string>& rows) {
  tin::frame::Frame frame = projected_frame();
  auto grid = std::make_shared<tin::terrain::SourceGrid>();
  grid->width = static_cast<std::int32_t>(rows[0].size());
  grid->height = static_cast<std::int32_t>(rows.size());
  grid->dx = 10000;
  grid->dy = -10000;
  grid->valid.assign((rows.size() * rows[0].size() + 63) / 64, 0);
  std::vector<Placement> placements;
  for (std::int32_t row = 0; row < grid->height; ++row) {
    for (std::int32_t column = 0; column < grid->width; ++column) {
      const char height = rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
      if (height == '.') continue;
      const auto bit = static_cast<std::size_t>(row * grid->width + column);
      grid->valid[bit / 64] |= std::uint64_t{1} << (bit % 64);
      placements.push_back({grid->centre(column, row), double(height - '0')});
    }
  }
  auto terrain = Terrain::build(frame, placements, Duplicates::kReject);
  EXPECT_TRUE(terrain.ok());
  terrain->set_source_grid(grid);
  return *std::move(terrain);
}

std::string written(const Terrain& terrain, std::string_view name, MeshRequest request) {
  auto mesh = proto::formats::TerrainMesh::create(terrain, std::move(request));
  EXPECT_TRUE(mesh.ok()) << mesh.error().message;
  const auto* entry = proto::formats::find_mesh_format(name);
  EXPECT_NE(entry, nullptr);
  const auto format = entry->make();
  std::string whole;
  const auto done = proto::formats::write_mesh(**mesh, *format, [&whole](std::string_view piece) {
    whole += piece;
    return tin::base::Result<void>();
  });
  EXPECT_TRUE(done.ok());
  return whole;
}

Terrain rebuilt(const proto::formats::MeshPoints& points) {
  EXPECT_TRUE(points.frame);
  const tin::frame::Frame frame = points.frame.value_or(tin::frame::Frame{});
  std::vector<Placement> placements;
  for (const proto::Position& at : points.points) {
    const auto lattice = frame.to_lattice(at.x, at.y);
    EXPECT_TRUE(lattice.ok());
    placements.push_back({*lattice, at.z});
  }
  auto terrain = Terrain::build(frame, placements, Duplicates::kReject);
  EXPECT_TRUE(terrain.ok());
  return *std::move(terrain);
}

}  // namespace tests::formats
