// Time that long work may take before it is to come to an end with what it has.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>

namespace server::app {

class TimeBudget {
 public:
  using Clock = std::chrono::steady_clock;

  /// Nothing: no limit. Requires: at most 1e9.
  explicit TimeBudget(std::optional<double> seconds, Clock::time_point start = Clock::now()) {
    if (seconds)
      end_ = start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(*seconds));
  }

  /// Whether time is up; empty without a limit. May be asked by several threads.
  std::function<bool()> question() const {
    if (!end_) return {};
    return [end = *end_, spent = spent_] {
      if (Clock::now() < end) return false;
      spent->store(true);
      return true;
    };
  }
  /// Whether anybody was told that it is.
  bool was_spent() const { return spent_->load(); }

 private:
  std::optional<Clock::time_point> end_;
  std::shared_ptr<std::atomic<bool>> spent_ = std::make_shared<std::atomic<bool>>(false);
};

}  // namespace server::app
