#include "tin/delaunay/threads.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <new>

namespace {

using tin::delaunay::on_threads;

TEST(ThreadsTest, EveryPartIsDoneOnce) {
  std::array<std::atomic<int>, 5> calls{};
  on_threads(5, [&](unsigned i) { ++calls[i]; });
  for (const auto& count : calls) EXPECT_EQ(count, 1);
}

TEST(ThreadsTest, WhatAPartThrowsReachesTheCallerWhenAllHaveEnded) {
  for (unsigned thrower = 0; thrower < 3; ++thrower) {
    std::atomic<int> ended = 0;
    const auto work = [&](unsigned i) {
      if (i == thrower) throw std::bad_alloc();
      ++ended;
    };
    EXPECT_THROW(on_threads(3, work), std::bad_alloc);
    EXPECT_EQ(ended, 2);
  }
}

}  // namespace
