#include "tin/codec/source.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/tin/codec/random_values.h"
#include "tests/tin/codec/resummed.h"

namespace tin::codec {
namespace {

using exact::Point;
using terrain::Placement;
using terrain::SourceGrid;
using terrain::SourceSamples;
using testing::Random;

struct Source {
  SourceSamples samples;
  std::shared_ptr<const SourceGrid> grid;
};

double any_height(Random& random, int kind) {
  switch (kind) {
    case 0:
      return testing::between(random, -50, 8848);
    case 1:
      return testing::between(random, -1000000, 1000000) / 16.0;
    case 2:
      return static_cast<float>(testing::between(random, 0, 1000000) / 1000.0);
    default:
      return testing::any_finite(random);
  }
}

Source any_raster(Random& random, int kind) {
  auto grid = std::make_shared<SourceGrid>();
  grid->width = testing::between(random, 1, 20);
  grid->height = testing::between(random, 1, 20);
  grid->dx = 7;
  grid->dy = -7;
  const auto pixels = static_cast<std::size_t>(grid->width * grid->height);
  if (testing::chance(random, 0.5)) {
    grid->valid.resize((pixels + 63) / 64);
    for (std::size_t bit = 0; bit < pixels; ++bit) {
      if (testing::chance(random, 0.7)) grid->valid[bit / 64] |= std::uint64_t{1} << (bit % 64);
    }
  }
  std::vector<double> heights;
  for (std::size_t i = 0; i < pixels; ++i) {
    const bool valid = grid->valid.empty() || ((grid->valid[i / 64] >> (i % 64)) & 1U) != 0;
    heights.push_back(valid ? any_height(random, kind) : std::nan(""));
  }
  return {SourceSamples::raster(grid, heights), grid};
}

Source any_points(Random& random, int kind) {
  std::vector<Placement> points;
  const int count = testing::between(random, 0, 60);
  for (int i = 0; i < count; ++i) points.push_back({testing::any_point(random), any_height(random, kind)});
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.at < b.at; });
  points.erase(
      std::unique(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.at == b.at; }),
      points.end());
  return {SourceSamples::points(points), nullptr};
}

Source any_source(Random& random) {
  const int kind = testing::between(random, 0, 3);
  return testing::chance(random, 0.6) ? any_raster(random, kind) : any_points(random, kind);
}

void expect_same(const SourceSamples& a, const SourceSamples& b) {
  ASSERT_EQ(a.size(), b.size());
  ASSERT_EQ(a.sample_count(), b.sample_count());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a.is_sample(i), b.is_sample(i));
    if (!a.is_sample(i)) continue;
    ASSERT_EQ(a.at(i), b.at(i));
    ASSERT_EQ(std::bit_cast<std::uint64_t>(a.z(i)), std::bit_cast<std::uint64_t>(b.z(i)));
  }
}

TEST(SourceCodecTest, RandomSourcesRoundTripToTheLastBit) {
  Random random(testing::seed());
  for (int round = 0; round < 1000 && !HasFailure(); ++round) {
    const Source source = any_source(random);
    const std::string bytes = encode_source(source.samples);
    const auto decoded = decode_source(bytes, source.grid);
    ASSERT_TRUE(decoded.ok()) << decoded.error().message;
    expect_same(*decoded, source.samples);
    ASSERT_EQ(encode_source(*decoded), bytes);
  }
}

TEST(SourceCodecTest, ASmoothRasterOfWholeMetresTakesAByteAPixel) {
  auto grid = std::make_shared<SourceGrid>();
  grid->width = grid->height = 200;
  grid->dx = grid->dy = 5;
  std::vector<double> heights;
  for (int i = 0; i < 200 * 200; ++i)
    heights.push_back(std::round(900 + 300 * std::sin(i % 200 / 30.0) * std::cos(i / 200 / 25.0)));
  EXPECT_LT(encode_source(SourceSamples::raster(grid, heights)).size(), heights.size() + 64);
}

TEST(SourceCodecTest, EveryTruncationIsAnError) {
  Random random(testing::seed());
  for (int round = 0; round < 30; ++round) {
    const Source source = any_source(random);
    const std::string bytes = encode_source(source.samples);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      ASSERT_FALSE(decode_source(bytes.substr(0, size), source.grid).ok()) << size;
      ASSERT_FALSE(decode_source(testing::resummed(bytes.substr(0, size)), source.grid).ok()) << size;
    }
    ASSERT_FALSE(decode_source(bytes + '\0', source.grid).ok());
  }
}

TEST(SourceCodecTest, DamageIsAnErrorAndBehindAFittingChecksumAnErrorOrAnotherSource) {
  Random random(testing::seed());
  int accepted = 0;
  for (int round = 0; round < 10000; ++round) {
    const Source source = any_source(random);
    const std::string bytes = encode_source(source.samples);
    const std::string bad = testing::damaged(bytes, testing::between(random, 1, 4), random);
    if (bad != bytes) {
      ASSERT_FALSE(decode_source(bad, source.grid).ok());
    }
    const auto decoded = decode_source(testing::resummed(bad), source.grid);
    if (!decoded.ok()) continue;
    ++accepted;
    ASSERT_EQ(encode_source(*decoded), testing::resummed(bad));
  }
  EXPECT_GT(accepted, 0);
}

TEST(SourceCodecTest, ARasterOfAnotherGridIsRefused) {
  Random random(1);
  const Source source = any_raster(random, 0);
  auto other = std::make_shared<SourceGrid>(*source.grid);
  other->valid.clear();
  ++other->width;
  EXPECT_FALSE(decode_source(encode_source(source.samples), other).ok());
  EXPECT_FALSE(decode_source(encode_source(source.samples), nullptr).ok());
  EXPECT_FALSE(decode_source(encode_source(any_points(random, 0).samples), source.grid).ok());
}

TEST(SourceCodecTest, NewerVersionsAreRefused) {
  std::string bytes = encode_source(SourceSamples::points({}));
  bytes[4] = 2;
  const auto decoded = decode_source(bytes, nullptr);
  ASSERT_FALSE(decoded.ok());
  EXPECT_EQ(decoded.error().code, base::Code::kUnsupported);
}

TEST(SourceCodecTest, PiecesMakeTheSameBytesAndTheSinkMayEndThem) {
  auto grid = std::make_shared<SourceGrid>();
  grid->width = 1500;
  grid->height = 1200;
  grid->dx = 7;
  grid->dy = -7;
  std::vector<double> heights;
  std::vector<Placement> points;
  for (int i = 0; i < 1500 * 1200; ++i) {
    heights.push_back(i % 1000 * 919 % 1000);
    if (i < 400'000) points.push_back({{i * 3, i % 1000 * 919 % 1000}, i % 999 + 0.5});
  }
  for (const auto& source : {SourceSamples::raster(grid, heights), SourceSamples::points(points)}) {
    std::string together;
    int pieces = 0;
    ASSERT_TRUE(encode_source(source, [&](std::string_view piece) -> base::Result<void> {
      together += piece;
      ++pieces;
      EXPECT_LT(piece.size(), std::size_t{3} << 20);
      return {};
    }));
    EXPECT_GT(pieces, 1);
    EXPECT_TRUE(together == encode_source(source));
    EXPECT_TRUE(decode_source(together, source.grid()));
    int taken = 0;
    const auto ended = encode_source(source, [&](std::string_view) -> base::Result<void> {
      ++taken;
      return base::error(base::Code::kNoSpace, "full");
    });
    EXPECT_EQ(ended.error().code, base::Code::kNoSpace);
    EXPECT_EQ(taken, 1);
  }
}

}  // namespace
}  // namespace tin::codec
