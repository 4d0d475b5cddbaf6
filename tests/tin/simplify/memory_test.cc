// Where a raster's heights lie is the caller's to say, and changes nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory_resource>
#include <vector>

#include "tests/tin/simplify/runs.h"
#include "tests/tin/simplify/terrains.h"
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
