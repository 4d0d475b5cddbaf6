// Running a function once per thread.
#pragma once

#include <thread>
#include <vector>

namespace tin::delaunay {

/// Calls f(0) .. f(threads - 1) at the same time, f(0) on this thread, and waits for all. f must not throw.
template <class F>
void on_threads(unsigned threads, const F& f) {
  std::vector<std::thread> others;
  others.reserve(threads);
  for (unsigned i = 1; i < threads; ++i) others.emplace_back([&f, i] { f(i); });
  f(0);
  for (std::thread& other : others) other.join();
}

/// The part of 0..count that thread `i` of `threads` works on begins here (and ends where part i + 1 begins).
constexpr std::size_t part_begin(std::size_t count, unsigned i, unsigned threads) { return count * i / threads; }

}  // namespace tin::delaunay
