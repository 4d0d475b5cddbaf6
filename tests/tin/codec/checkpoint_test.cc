#include "tin/codec/checkpoint.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/tin/codec/random_values.h"
#include "tests/tin/codec/resummed.h"
#include "tin/exact/predicates.h"

namespace tin::codec {
namespace {

using terrain::SourceGrid;
using terrain::VertexId;
using testing::Random;

frame::Axis any_axis(Random& random) {
  const std::int64_t parts = static_cast<std::int64_t>(random() >> testing::between(random, 1, 63));
  return {testing::any_finite(random), std::abs(testing::any_finite(random)) + 1e-9,
          std::max<std::int64_t>(1, parts)};
}

SourceGrid any_grid(Random& random) {
  SourceGrid grid;
  grid.width = testing::between(random, 1, 40);
  grid.height = testing::between(random, 1, 40);
  grid.x0 = testing::between(random, -1000000, 1000000);
  grid.y0 = testing::between(random, -1000000, 1000000);
  grid.dx = testing::between(random, 1, 100000);
  grid.dy = testing::chance(random, 0.8) ? -grid.dx : testing::between(random, 1, 100000);
  for (double& value : grid.geotransform) value = testing::any_finite(random);
  if (testing::chance(random, 0.5))
    grid.nodata = testing::chance(random, 0.5) ? -9999.0 : std::bit_cast<double>(random());
  grid.data_type = testing::any_text(random);
  if (testing::chance(random, 0.3)) return grid;
  const auto pixels = static_cast<std::size_t>(grid.width * grid.height);
  grid.valid.resize((pixels + 63) / 64);
  const double density = testing::between(random, 0, 4) / 4.0;
  for (std::size_t bit = 0; bit < pixels; ++bit) {
    if (testing::chance(random, density)) grid.valid[bit / 64] |= std::uint64_t{1} << (bit % 64);
  }
  return grid;
}

std::vector<terrain::EditedTriangle> any_areas(Random& random) {
  std::vector<terrain::EditedTriangle> areas;
  for (int i = testing::between(random, 0, 5); i > 0; --i) {
    terrain::EditedTriangle t{
        {testing::any_point(random), testing::any_point(random), testing::any_point(random)},
        static_cast<std::uint8_t>(testing::between(random, 0, 7))};
    if (exact::orientation(t.corners[0], t.corners[1], t.corners[2]) > 0) areas.push_back(terrain::with_least_first(t));
  }
  return areas;
}

terrain::Amendments any_amendments(Random& random, bool has_grid) {
  terrain::Amendments::Parts parts;
  parts.kind = has_grid && testing::chance(random, 0.5) ? terrain::SourceKind::kRaster : terrain::SourceKind::kPoints;
  parts.thinned = testing::chance(random, 0.5);
  parts.areas = any_areas(random);
  std::size_t left = parts.areas.size();
  while (testing::chance(random, 0.7)) {
    const auto triangles = testing::between<std::size_t>(random, 0, left);
    left -= triangles;
    parts.next_deed += testing::between<std::uint64_t>(random, 0, 200);
    parts.deeds.push_back({parts.next_deed++, random(), triangles, testing::chance(random, 0.5)});
  }
  const auto any_deed = [&] {
    const auto which = testing::between<std::size_t>(random, 0, parts.deeds.size());
    return which == parts.deeds.size() ? 0 : parts.deeds[which].number;
  };
  std::set<std::pair<exact::Point, std::uint64_t>> touches;
  for (int i = testing::between(random, 0, 5); i > 0; --i) touches.emplace(testing::any_point(random), any_deed());
  for (const auto& [at, deed] : touches) parts.touches.push_back({at, deed});
  std::map<std::pair<exact::Point, std::uint64_t>, double> own;
  for (int i = testing::between(random, 0, 5); i > 0; --i)
    own.emplace(std::pair(testing::any_point(random), any_deed()), testing::any_finite(random));
  for (const auto& [key, z] : own) parts.own.push_back({{key.first, z}, key.second});
  return terrain::Amendments(std::move(parts));
}

Checkpoint any_checkpoint(Random& random) {
  Checkpoint checkpoint;
  checkpoint.revision = random() >> testing::between(random, 0, 63);
  checkpoint.digest = testing::any_text(random);
  checkpoint.duplicates = static_cast<terrain::Duplicates>(testing::between(random, 0, 5));
  checkpoint.frame = {testing::any_text(random), any_axis(random), any_axis(random),
                      testing::any_text(random), std::abs(testing::any_finite(random)) + 1e-9};
  const int vertices = testing::chance(random, 0.2) ? 0 : testing::between(random, 0, 30);
  std::uint64_t id = 0;
  for (int i = 0; i < vertices; ++i) {
    id +=
        testing::between<std::uint64_t>(random, 1, testing::chance(random, 0.9) ? 3 : std::uint64_t{1} << 50);
    const terrain::Placement placement = testing::any_placement(random);
    checkpoint.vertices.push_back({VertexId(id), placement.at, placement.z});
  }
  checkpoint.next_id = VertexId(id + testing::between<std::uint64_t>(random, 1, 5));
  if (checkpoint.next_id.value() == 1 && testing::chance(random, 0.5)) checkpoint.open_resolution = {0.0, 1.5};
  if (testing::chance(random, 0.6)) checkpoint.grid = std::make_shared<const SourceGrid>(any_grid(random));
  if (testing::chance(random, 0.6))
    checkpoint.amendments = any_amendments(random, checkpoint.grid != nullptr);
  return checkpoint;
}

// Doubles compared by their bits, so that a NaN nodata equals itself.
void expect_same_grid(const SourceGrid& a, const SourceGrid& b) {
  ASSERT_EQ(a.nodata.has_value(), b.nodata.has_value());
  if (a.nodata) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(*a.nodata), std::bit_cast<std::uint64_t>(*b.nodata));
  }
  SourceGrid a_rest = a;
  SourceGrid b_rest = b;
  a_rest.nodata.reset();
  b_rest.nodata.reset();
  EXPECT_EQ(a_rest, b_rest);
}

void expect_same(const Checkpoint& a, const Checkpoint& b) {
  EXPECT_EQ(a.revision, b.revision);
  EXPECT_EQ(a.digest, b.digest);
  EXPECT_EQ(a.next_id, b.next_id);
  EXPECT_EQ(a.duplicates, b.duplicates);
  EXPECT_EQ(a.frame, b.frame);
  EXPECT_EQ(a.open_resolution, b.open_resolution);
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  for (std::size_t i = 0; i < a.vertices.size(); ++i) {
    EXPECT_EQ(a.vertices[i].id, b.vertices[i].id);
    EXPECT_EQ(a.vertices[i].at, b.vertices[i].at);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(a.vertices[i].z), std::bit_cast<std::uint64_t>(b.vertices[i].z));
  }
  ASSERT_EQ(a.grid == nullptr, b.grid == nullptr);
  if (a.grid) expect_same_grid(*a.grid, *b.grid);
  EXPECT_EQ(a.amendments, b.amendments);
}

TEST(CheckpointCodecTest, RandomCheckpointsRoundTrip) {
  Random random(testing::seed());
  for (int round = 0; round < 1000 && !HasFailure(); ++round) {
    const Checkpoint checkpoint = any_checkpoint(random);
    const std::string bytes = encode_checkpoint(checkpoint);
    const auto decoded = decode_checkpoint(bytes);
    ASSERT_TRUE(decoded.ok()) << decoded.error().message;
    expect_same(*decoded, checkpoint);
    ASSERT_EQ(encode_checkpoint(*decoded), bytes);
  }
}

/// Written before edits were told apart: what they touched stays touched, and nobody knows which triangles are whose.
TEST(CheckpointCodecTest, TheSecondVersionIsRead) {
  const std::string_view bytes(
      "\x54\x4e\x53\x43\x02\x00\x04\x00\x03\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\xf0\x3f\xe8"
      "\x07\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\xf0\x3f\xe8\x07\x00\x00\x00\x00\x00\x00\x00\xf0\x3f"
      "\x00\x02\x01\x00\x00\x00\x00\x00\x00\x00\x00\xf0\x3f\x01\x12\x00\x00\x00\x00\x00\x00\x00\x04\x40\x00\x02\x01\x02"
      "\x0f\x04\x06\x09\x01\x07\x06\x12\x00\x11\x12\x05\x01\x08\x17\x00\x00\x00\x00\x00\x00\x1e\x40\xbf\x2c\x6e\x79",
      111);
  const auto decoded = decode_checkpoint(bytes);
  ASSERT_TRUE(decoded.ok()) << decoded.error().message;
  EXPECT_EQ(decoded->vertices.size(), 2U);
  terrain::Amendments::Parts parts;
  parts.kind = terrain::SourceKind::kPoints;
  parts.thinned = true;
  parts.touches = {{{1, 2}, 0}, {{4, -3}, 0}};
  parts.areas = {{{exact::Point{0, 0}, exact::Point{9, 0}, exact::Point{0, 9}}, 5}};
  parts.own = {{{{4, -3}, 7.5}, 0}};
  EXPECT_EQ(decoded->amendments, terrain::Amendments(parts));
  EXPECT_EQ(decode_checkpoint(encode_checkpoint(*decoded))->amendments, terrain::Amendments(parts));
}

TEST(CheckpointCodecTest, EveryTruncationIsAnError) {
  Random random(testing::seed());
  for (int round = 0; round < 20; ++round) {
    const std::string bytes = encode_checkpoint(any_checkpoint(random));
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      ASSERT_FALSE(decode_checkpoint(bytes.substr(0, size)).ok()) << size << " of " << bytes.size();
      const auto summed = decode_checkpoint(testing::resummed(bytes.substr(0, size)));
      ASSERT_FALSE(summed.ok()) << size << " of " << bytes.size();
    }
    ASSERT_FALSE(decode_checkpoint(bytes + '\0').ok());
  }
}

TEST(CheckpointCodecTest, FlippedBitsAreAnError) {
  Random random(testing::seed());
  for (int round = 0; round < 3000; ++round) {
    ASSERT_FALSE(
        decode_checkpoint(testing::damaged(encode_checkpoint(any_checkpoint(random)), 1, random)).ok());
  }
}

TEST(CheckpointCodecTest, DamageBehindAFittingChecksumIsAnErrorOrAnotherCheckpoint) {
  Random random(testing::seed());
  int accepted = 0;
  for (int round = 0; round < 20000; ++round) {
    const std::string bytes = encode_checkpoint(any_checkpoint(random));
    const std::string bad =
        testing::resummed(testing::damaged(bytes, testing::between(random, 1, 4), random));
    const auto decoded = decode_checkpoint(bad);
    if (!decoded.ok()) continue;
    ++accepted;
    if (bad[4] == 2) continue;  // what is read of the second version is written as the third
    ASSERT_EQ(encode_checkpoint(*decoded), bad);
  }
  EXPECT_GT(accepted, 0);
}

Checkpoint with_grid(std::int32_t width, std::int32_t height, std::int32_t step) {
  SourceGrid grid;
  grid.width = width;
  grid.height = height;
  grid.x0 = -width / 2 * step;
  grid.y0 = -height / 2 * step;
  grid.dx = grid.dy = step;
  Checkpoint checkpoint;
  checkpoint.grid = std::make_shared<const SourceGrid>(grid);
  return checkpoint;
}

TEST(CheckpointCodecTest, GridsUpToTheLimitAreReadAndLargerOnesRefused) {
  const std::string bytes = encode_checkpoint(with_grid(1 << 15, 1 << 15, 1));
  EXPECT_TRUE(decode_checkpoint(bytes).ok());
  // The width, 2^15, is the only place with these bytes before the equal height: one more exceeds 2^30
  // pixels.
  const std::size_t width = bytes.find("\x80\x80\x02\x80\x80\x02");
  ASSERT_NE(width, std::string::npos);
  std::string larger = bytes;
  larger[width] = '\x81';
  const auto decoded = decode_checkpoint(testing::resummed(larger));
  ASSERT_FALSE(decoded.ok());
  EXPECT_EQ(decoded.error().code, base::Code::kMalformed);
}

TEST(CheckpointCodecTest, GridsReachToTheLatticesEdgeAndNoFurther) {
  Checkpoint checkpoint = with_grid(2, 2, 5);
  SourceGrid grid = *checkpoint.grid;
  grid.x0 = exact::kLatticeHalf - 1 - grid.dx;
  checkpoint.grid = std::make_shared<const SourceGrid>(grid);
  const std::string bytes = encode_checkpoint(checkpoint);
  EXPECT_TRUE(decode_checkpoint(bytes).ok());
  const std::size_t geometry = bytes.rfind("\x02\x02");  // width, height; then five bytes of x0
  ASSERT_NE(geometry, std::string::npos);
  std::string wider = bytes;
  wider[geometry] = 3;
  EXPECT_FALSE(decode_checkpoint(testing::resummed(wider)).ok());
}

TEST(CheckpointCodecTest, NewerVersionsAreRefused) {
  std::string bytes = encode_checkpoint(Checkpoint{});
  bytes[4] = 4;
  const auto decoded = decode_checkpoint(bytes);
  ASSERT_FALSE(decoded.ok());
  EXPECT_EQ(decoded.error().code, base::Code::kUnsupported);
}

TEST(CheckpointCodecTest, AJournalRecordIsNoCheckpoint) {
  const auto decoded = decode_checkpoint(std::string("TNSJ\x01\x00\x00\x00\x00\x00\x00", 11));
  ASSERT_FALSE(decoded.ok());
  EXPECT_EQ(decoded.error().message, "checkpoint: does not start as one");
}

}  // namespace
}  // namespace tin::codec
