// Where a raster's heights lie is the caller's to say, and changes nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory_resource>
#include <vector>

#include "tests/tin/simplify/runs.h"
#include "tests/tin/simplify/terrains.h"
#include "tin/simplify/footprint.h"
#include "tin/terrain/heights_builder.h"

namespace {

using support::SimplifyTest;
using tin::simplify::Options;
using tin::terrain::HeightsBuilder;
using tin::terrain::SourceSamples;

/// Counts what is taken from it and what is out.
class Counting : public std::pmr::memory_resource {
 public:
  std::size_t taken = 0, out = 0, calls = 0;

 private:
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    taken += bytes;
    out += bytes;
    ++calls;
    return std::pmr::new_delete_resource()->allocate(bytes, alignment);
  }
  void do_deallocate(void* memory, std::size_t bytes, std::size_t alignment) override {
    out -= bytes;
    std::pmr::new_delete_resource()->deallocate(memory, bytes, alignment);
  }
  bool do_is_equal(const memory_resource& other) const noexcept override { return this == &other; }
};

/// Waves with a void; all heights whole multiples of `unit`, or none when it is 0.
SourceSamples waves(std::int32_t size, double unit) {
  const auto terrain =
      support::raster_terrain(support::heights(size, size, [](std::int32_t, std::int32_t) { return 0.0; }));
  std::vector<double> z;
  for (std::int32_t row = 0; row < size; ++row) {
    for (std::int32_t column = 0; column < size; ++column) {
      const double height = 100 * std::sin(column / 9.0) * std::cos(row / 7.0);
      const bool is_void = column > 20 && column < 30 && row > 40 && row < 60;
      z.push_back(is_void    ? std::numeric_limits<double>::quiet_NaN()
                  : unit > 0 ? std::round(height / unit) * unit
                             : height);
    }
  }
  return SourceSamples::raster(terrain.shared_source_grid(), z);
}

TEST_F(SimplifyTest, TheOneArrayOfARastersSizeIsWhereItIsWanted) {
  constexpr std::int32_t kSize = 300;
  for (const double unit : {1.0, 0.0}) {
    const SourceSamples source = waves(kSize, unit);
    for (const auto effort : {tin::simplify::Effort::kFast, tin::simplify::Effort::kBalanced}) {
      Options options = support::to(2, effort);
      const auto here = tin::simplify::simplify_samples(source, options, nullptr);
      Counting memory;
      options.memory = &memory;
      options.threads = 2;
      const auto there = tin::simplify::simplify_samples(source, options, nullptr);
      ASSERT_TRUE(here.ok() && there.ok());
      EXPECT_EQ(there->vertices, here->vertices);
      EXPECT_EQ(there->report.worst->at, here->report.worst->at);
      EXPECT_EQ(memory.calls, 1U);
      EXPECT_EQ(memory.out, 0U);
      const std::size_t heights = kSize * kSize * (unit > 0 ? sizeof(std::int32_t) : sizeof(double));
      EXPECT_GE(memory.taken, heights);
      EXPECT_LE(memory.taken, heights + 64);
    }
  }
}

/// Where there is enough the result is the same; where there is not it is refused, whatever takes it.
TEST_F(SimplifyTest, ThereIsRoomOrItSaysThatThereIsNone) {
  const SourceSamples raster = waves(300, 10);
  std::vector<tin::terrain::Placement> some;
  for (std::size_t i = 0; i < raster.size(); i += 3) {
    if (raster.is_sample(i)) some.push_back({raster.at(i), raster.z(i)});
  }
  const SourceSamples points = SourceSamples::points(some);
  const auto ask = [](double tolerance, std::size_t flat, tin::simplify::Against against) {
    Options options = support::to(tolerance, tin::simplify::Effort::kFast);
    options.keep_flat = flat;
    options.against = against;
    options.threads = 2;
    return options;
  };
  using tin::simplify::Against;
  for (const auto& [source, options] :
       {std::pair(&raster, ask(1, 0, Against::kSamples)), std::pair(&raster, ask(40, 5, Against::kSamples)),
        std::pair(&raster, ask(40, 0, Against::kSurface)),
        std::pair(&points, ask(40, 0, Against::kSamples))}) {
    std::size_t most = 0;
    Options asking = options;
    asking.room = [&most](std::size_t bytes) {
      most = std::max(most, bytes);
      return true;
    };
    const auto free = tin::simplify::simplify_samples(*source, asking, nullptr);
    ASSERT_TRUE(free.ok());
    ASSERT_GT(most, 1'000'000U) << "nothing was asked for";
    const auto within = [&](std::size_t limit) {
      Options bounded = options;
      bounded.threads = 1;
      bounded.room = [limit](std::size_t bytes) { return bytes <= limit; };
      return tin::simplify::simplify_samples(*source, bounded, nullptr);
    };
    const auto enough = within(2 * most);
    ASSERT_TRUE(enough.ok());
    EXPECT_EQ(enough->vertices, free->vertices);
    const auto refused = within(most / 2);
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().code, tin::base::Code::kTooLarge);
  }
}

TEST(Footprint, AsksBeforeItIsOverAndIsOverForGood) {
  std::vector<std::size_t> asked;
  tin::simplify::Footprint footprint([&asked](std::size_t bytes) {
    asked.push_back(bytes);
    return bytes <= (std::size_t{3} << 20);
  });
  EXPECT_TRUE(footprint.take(1));
  ASSERT_EQ(asked.size(), 1U);
  EXPECT_TRUE(footprint.take(asked[0] - 1)) << "granted already";
  EXPECT_EQ(asked.size(), 1U);
  EXPECT_TRUE(footprint.take(1));
  footprint.add_vertices(-1);
  EXPECT_FALSE(footprint.is_over());
  EXPECT_FALSE(footprint.take(std::size_t{2} << 20));
  EXPECT_TRUE(footprint.is_over());
  footprint.add_vertices(-4000);
  EXPECT_FALSE(footprint.take(1));
  EXPECT_TRUE(footprint.is_over());
  EXPECT_EQ(asked.size(), 3U);
  EXPECT_TRUE(tin::simplify::Footprint({}).take(std::size_t{1} << 40));
}

TEST(HeightsBuilder, NarrowHeightsKeepTheirMemoryWhenTheyAreAssigned) {
  Counting memory;
  {
    HeightsBuilder builder(1000, &memory);
    for (int i = 0; i < 1000; ++i) builder.add(i);
    SourceSamples::Heights heights;
    heights = std::move(builder).finish();
    EXPECT_EQ(memory.calls, 1U);
    EXPECT_EQ(memory.out, 1000 * sizeof(std::int16_t));
    EXPECT_EQ(heights.at(999), 999);
  }
  EXPECT_EQ(memory.out, 0U);
}

TEST(HeightsBuilder, WidensWhereItWasTold) {
  Counting memory;
  {
    HeightsBuilder builder(4, &memory);
    const auto calls = [&memory] { return memory.calls; };
    builder.add(1);
    EXPECT_EQ(calls(), 1U);
    builder.add(70000);
    EXPECT_EQ(calls(), 2U);
    builder.add(0.1);
    builder.skip();
    auto heights = std::move(builder).finish();
    EXPECT_EQ(heights.stored.index(), 3U);
    EXPECT_EQ(heights.at(0), 1);
    EXPECT_EQ(heights.at(1), 70000);
    EXPECT_EQ(heights.at(2), 0.1);
    EXPECT_EQ(memory.out, 4 * sizeof(double));
    // Where it goes from there, it stays in that memory.
    SourceSamples::Heights moved;
    moved = std::move(heights);
    EXPECT_EQ(memory.out, 4 * sizeof(double));
    EXPECT_EQ(moved.at(2), 0.1);
  }
  EXPECT_EQ(memory.out, 0U);
}

}  // namespace
