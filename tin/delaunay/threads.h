// Running a function once per thread.
#pragma once

#include <cstddef>
#include <system_error>
#include <thread>
#include <vector>

namespace tin::delaunay {

/// Calls f(0) .. f(threads - 1) at the same time, f(0) on this thread, and waits for all; one after the other where the system
/// gives no more threads. f must not throw.
template <class F>
void on_threads(unsigned threads, const F& f) {
  std::vector<std::thread> others;
  others.reserve(threads);
  unsigned started = 1;
  try {
    for (; started < threads; ++started) others.emplace_back([&f, i = started] { f(i); });
  } catch (const std::system_error&) {
    // What has no thread of its own is done here.
  }
  f(0);
  for (unsigned i = started; i < threads; ++i) f(i);
  for (std::thread& other : others) other.join();
}

/// The part of 0..count that thread `i` of `threads` works on begins here (and ends where part i + 1 begins).
constexpr std::size_t part_begin(std::size_t count, unsigned i, unsigned threads) { return count * i / threads; }

}  // namespace tin::delaunay
