// Time that long work may take before it is to come to an end with what it has.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>

#include "tin/base/progress.h"

namespace server::app {

class TimeBudget {
 public:
  using Clock = std::chrono::steady_clock;
  using Seconds = std::chrono::duration<double>;

  /// Nothing: no limit. Requires: at most 1e9.
  explicit TimeBudget(std::optional<double> seconds, Clock::time_point start = Clock::now()) : start_(start) {
    if (seconds)
      end_ = start + std::chrono::duration_cast<Clock::duration>(Seconds(*seconds));
  }

  /// Whether time is up; empty without a limit. May be asked by several threads. Each time it tells `progress`
  /// (null: nobody; it must outlive the question) what part of the time is gone, as that of the present phase:
  /// work that goes on until time is up is as far as the clock, whatever it makes of itself.
  std::function<bool()> question(tin::base::Progress* progress = nullptr) const {
    if (!end_) return {};
    return [start = start_, end = *end_, spent = spent_, progress] {
      const auto now = Clock::now();
      if (progress != nullptr) progress->report(std::min(1.0, Seconds(now - start) / Seconds(end - start)));
      if (now < end) return false;
      spent->store(true);
      return true;
    };
  }
  /// Whether anybody was told that it is.
  bool was_spent() const { return spent_->load(); }

 private:
  Clock::time_point start_;
  std::optional<Clock::time_point> end_;
  std::shared_ptr<std::atomic<bool>> spent_ = std::make_shared<std::atomic<bool>>(false);
};

}  // namespace server::app
