// The memory that bodies read into memory, and answers that wait for slow clients, take in all.
#pragma once

#include <atomic>
#include <cstdint>

namespace server::http {

/// One request's share of it, given back at the end of the scope. What is small is not counted: the number of
/// connections bounds it, and short requests go on when there is no room for long ones. One thread at a time.
class Buffered {
 public:
  static constexpr std::uint64_t kSmall = 16 * 1024;

  Buffered(std::atomic<std::uint64_t>& of_all, std::uint64_t limit) : of_all_(of_all), limit_(limit) {}
  Buffered(const Buffered&) = delete;
  Buffered& operator=(const Buffered&) = delete;
  ~Buffered() { of_all_ -= counted_; }

  /// The same, whether there is room or not.
  void force(std::uint64_t bytes) {
    resize(0);
    counted_ = bytes <= kSmall ? 0 : bytes;
    of_all_ += counted_;
  }

  /// Makes the share that of `bytes`. False when there is no room: then it is what it was.
  bool resize(std::uint64_t bytes) {
    const std::uint64_t wanted = bytes <= kSmall ? 0 : bytes;
    if (wanted > counted_) {
      const std::uint64_t more = wanted - counted_;
      if (of_all_.fetch_add(more) + more > limit_) {
        of_all_ -= more;
        return false;
      }
    } else {
      of_all_ -= counted_ - wanted;
    }
    counted_ = wanted;
    return true;
  }

 private:
  std::atomic<std::uint64_t>& of_all_;
  const std::uint64_t limit_;
  std::uint64_t counted_ = 0;
};

}  // namespace server::http
