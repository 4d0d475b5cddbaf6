// Running a function once per thread.
#pragma once

#include <cstddef>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

namespace tin::delaunay {

/// Calls f(0) .. f(threads - 1) at the same time, f(0) on this thread, and waits for all; one after the other
/// where the system gives no more threads. What a call throws (memory may run out) is thrown here when all
/// have ended, the first one's of several.
template <class F>
void on_threads(unsigned threads, const F& f) {
  std::vector<std::exception_ptr> thrown(threads);
  const auto call = [&](unsigned i) {
    try {
      f(i);
    } catch (...) {
      thrown[i] = std::current_exception();
    }
  };
  std::vector<std::thread> others;
  others.reserve(threads);
  unsigned started = 1;
  try {
    for (; started < threads; ++started) others.emplace_back([&call, i = started] { call(i); });
  } catch (const std::system_error&) {
    // What has no thread of its own is done here.
  }
  call(0);
  for (unsigned i = started; i < threads; ++i) call(i);
  for (std::thread& other : others) other.join();
  for (const std::exception_ptr& e : thrown) {
    if (e) std::rethrow_exception(e);
  }
}

/// The part of 0..count that thread `i` of `threads` works on begins here (and ends where part i + 1 begins).
constexpr std::size_t part_begin(std::size_t count, unsigned i, unsigned threads) {
  return count * i / threads;
}

}  // namespace tin::delaunay
