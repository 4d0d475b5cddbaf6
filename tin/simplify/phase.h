// A part of a longer work: its own 0..1 is a stretch of the whole.
#pragma once

#include "tin/base/progress.h"

namespace tin::simplify {

class Phase {
 public:
  Phase(base::Progress* progress, double from, double to) : progress_(progress), from_(from), to_(to) {}

  void report(double fraction) const {
    if (progress_ != nullptr) progress_->report(from_ + (to_ - from_) * fraction);
  }
  bool cancelled() const { return progress_ != nullptr && progress_->cancelled(); }
  Phase part(double from, double to) const {
    return {progress_, from_ + (to_ - from_) * from, from_ + (to_ - from_) * to};
  }

 private:
  base::Progress* progress_;
  double from_, to_;
};

}  // namespace tin::simplify
