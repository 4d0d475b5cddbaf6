#include "tin/delaunay/threads.h"

#include <gtest/gtest.h>

#include <array>
#include <new>
#include <stdexcept>
#include <string>

namespace {

using tin::delaunay::on_threads;

TEST(ThreadsTest, CallsOncePerThread) {
  std::array<int, 5> calls{};
  on_threads(5, [&](unsigned i) { ++calls[i]; });
  for (const int n : calls) EXPECT_EQ(n, 1);
}

TEST(ThreadsTest, WhatAThreadThrowsReachesTheCallerOnceAllHaveEnded) {
  for (unsigned thrower = 0; thrower < 3; ++thrower) {
    std::array<int, 3> ended{};
    const auto work = [&](unsigned i) {
      if (i == thrower) throw std::bad_alloc();
      ++ended[i];
    };
    EXPECT_THROW(on_threads(3, work), std::bad_alloc);
    for (unsigned i = 0; i < 3; ++i) EXPECT_EQ(ended[i], i == thrower ? 0 : 1);
  }
}

TEST(ThreadsTest, TheFirstOfSeveralExceptionsIsThrown) {
  const auto work = [](unsigned i) { throw std::runtime_error(std::to_string(i)); };
  try {
    on_threads(4, work);
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "0");
  }
}

}  // namespace
