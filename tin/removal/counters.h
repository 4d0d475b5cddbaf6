// What a deletion method did, counted in the paper's units. A method is a template on where it counts: with
// NoCounters every count is an empty inline function, so that production pays nothing.
#pragma once

#include <cstdint>

namespace tin::removal {

struct Counters {
  std::uint64_t in_circle_tests = 0;  // sides of a plane through three lifted points, infinite ones included
  std::uint64_t power_computations = 0;
  std::uint64_t power_updates = 0;
  std::uint64_t comparisons = 0;         // of two powers
  std::uint64_t filter_failures = 0;     // comparisons that floating point left in doubt
  std::uint64_t exact_evaluations = 0;   // the same comparisons, by whole numbers
  std::uint64_t gmp_evaluations = 0;     // of these, too large for 128 bits
  std::uint64_t power_ties = 0;          // and those that came down to the infinitesimals

  void in_circle_test() { ++in_circle_tests; }
  void power_computation() { ++power_computations; }
  void power_update() { ++power_updates; }
  void comparison() { ++comparisons; }
  void filter_failure() { ++filter_failures; }
  void exact_evaluation() { ++exact_evaluations; }
  void gmp_evaluation() { ++gmp_evaluations; }
  void power_tie() { ++power_ties; }
};

struct NoCounters {
  void in_circle_test() {}
  void power_computation() {}
  void power_update() {}
  void comparison() {}
  void filter_failure() {}
  void exact_evaluation() {}
  void gmp_evaluation() {}
  void power_tie() {}
};

}  // namespace tin::removal
