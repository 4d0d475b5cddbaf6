// Progress of long work, and the request to stop it.
#pragma once

#include <atomic>

namespace tin::base {

/// Shared between one worker, which reports, and anyone who watches or cancels. Thread-safe.
class Progress {
 public:
  /// `fraction` of the work done, 0..1.
  void report(double fraction) { fraction_.store(fraction, std::memory_order_relaxed); }
  double fraction() const { return fraction_.load(std::memory_order_relaxed); }

  void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  /// Long loops ask at least every few milliseconds, and return Code::kCancelled when true.
  bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

 private:
  std::atomic<double> fraction_{0};
  std::atomic<bool> cancelled_{false};
};

}  // namespace tin::base
