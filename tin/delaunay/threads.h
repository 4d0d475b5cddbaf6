// Running a function once per thread.
#pragma once

#include <cstddef>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

namespace tin::delaunay {

/// Calls f(0) .. f(threads - 1) at the same time, f(0) on this thread, and waits for all; one after the other where the system
/// gives no more threads. When calls throw, the first one's exception is thrown again, once all have ended.
template <class F>
void on_threads(unsigned threads, const F& f) {
  std::vector<std::exception_ptr> failures(threads);
  const auto guarded = [&](unsigned i) {
    try {
      f(i);
    } catch (...) {
      failures[i] = std::current_exception();
    }
  };
  std::vector<std::thread> others;
  others.reserve(threads);
  unsigned started = 1;
  try {
    for (; started < threads; ++started) others.emplace_back([&guarded, i = started] { guarded(i); });
  } catch (const std::system_error&) {
    // What has no thread of its own is done here.
  }
  guarded(0);
  for (unsigned i = started; i < threads; ++i) guarded(i);
  for (std::thread& other : others) other.join();
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

/// The part of 0..count that thread `i` of `threads` works on begins here (and ends where part i + 1 begins).
constexpr std::size_t part_begin(std::size_t count, unsigned i, unsigned threads) { return count * i / threads; }

}  // namespace tin::delaunay
