// How long a transfer may keep us waiting.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

#include "server/http/options.h"

namespace server::http {

/// Some time at first, then as much as the lowest rate needs, and never longer than the stall timeout at
/// once. Only time spent waiting for the client counts.
class Patience {
 public:
  using Duration = std::chrono::steady_clock::duration;

  Patience(Duration first, const ServerOptions& options)
      : first_(first), stall_(options.stall_timeout), rate_(options.min_bytes_per_second) {}

  /// How long the next step may take; none left if not positive.
  Duration left() const {
    const std::chrono::seconds earned(static_cast<std::int64_t>(bytes_ / rate_));
    return std::min<Duration>(first_ + earned - waited_, stall_);
  }

  void record(std::uint64_t bytes, Duration waited) {
    bytes_ += bytes;
    waited_ += waited;
  }

 private:
  Duration first_;
  Duration stall_;
  std::uint64_t rate_;
  std::uint64_t bytes_ = 0;
  Duration waited_{0};
};

}  // namespace server::http
