// Progress of long work, and the request to stop it.
#pragma once

#include <atomic>

namespace tin::base {

/// Shared between one worker, which reports, and anyone who watches or cancels. Thread-safe. It never falls: who
/// reports less than is known already, as one of several threads or of several measures, changes nothing.
class Progress {
 public:
  Progress() = default;
  /// Of a part of the work that reports to nobody: cancelled when `whole` is, which may be null and must
  /// outlive it.
  explicit Progress(const Progress* whole) : whole_(whole) {}

  /// `fraction` of the present phase done, 0..1; without phases, of the work.
  void report(double fraction) {
    const double now = phase_begin_ + fraction * (phase_end_ - phase_begin_);
    double known = fraction_.load(std::memory_order_relaxed);
    while (known < now && !fraction_.compare_exchange_weak(known, now, std::memory_order_relaxed)) {
    }
  }
  /// What is reported from now on is a part of the whole, from `begin` to `end`. For the worker.
  void begin_phase(double begin, double end) {
    phase_begin_ = begin;
    phase_end_ = end;
    report(0);
  }
  double fraction() const { return fraction_.load(std::memory_order_relaxed); }

  void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  /// Long loops ask at least every few milliseconds, and return Code::kCancelled when true.
  bool cancelled() const {
    return cancelled_.load(std::memory_order_relaxed) || (whole_ != nullptr && whole_->cancelled());
  }

 private:
  const Progress* whole_ = nullptr;
  double phase_begin_ = 0;
  double phase_end_ = 1;
  std::atomic<double> fraction_{0};
  std::atomic<bool> cancelled_{false};
};

}  // namespace tin::base
