// A part of a longer work: its own 0..1 is a stretch of the whole.
#pragma once

#include <atomic>
#include <functional>

#include "tin/base/progress.h"

namespace tin::simplify {

/// Whether time is up; empty: it never is. Asked by several threads at once.
using OutOfTime = std::function<bool()>;

class Phase {
 public:
  Phase(base::Progress* progress, double from, double to) : progress_(progress), from_(from), to_(to) {}

  void report(double fraction) const {
    if (progress_ != nullptr && reports_) progress_->report(from_ + (to_ - from_) * fraction);
  }
  bool cancelled() const {
    return (progress_ != nullptr && progress_->cancelled()) || (stop_ != nullptr && *stop_);
  }
  Phase part(double from, double to) const {
    return {progress_, stop_, from_ + (to_ - from_) * from, from_ + (to_ - from_) * to, reports_};
  }
  /// The same that reports nothing: for one of several threads.
  Phase silent() const { return {progress_, stop_, from_, to_, false}; }
  /// The same that is also cancelled once `stop`, which must outlive it, says true.
  Phase until(const std::atomic<bool>& stop) const { return {progress_, &stop, from_, to_, reports_}; }

 private:
  Phase(base::Progress* progress, const std::atomic<bool>* stop, double from, double to, bool reports)
      : progress_(progress), stop_(stop), from_(from), to_(to), reports_(reports) {}

  base::Progress* progress_;
  const std::atomic<bool>* stop_ = nullptr;
  double from_, to_;
  bool reports_ = true;
};

}  // namespace tin::simplify
