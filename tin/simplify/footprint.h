// What simplification takes in memory beside a raster's samples, so that somebody may say that it is too
// much.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <utility>

namespace tin::simplify {

/// Whether there is room for so many bytes in all. Asked by several threads, one at a time.
using Room = std::function<bool(std::size_t bytes)>;

/// An estimate that errs upwards. Thread-safe.
class Footprint {
 public:
  /// Of one vertex of the TIN while it is worked on, with its triangles, queues and pins; measured, rounded
  /// up.
  static constexpr std::size_t kBytesPerVertex = 256;

  /// Empty: there is always room.
  explicit Footprint(Room room) : room_(std::move(room)) {}

  /// Takes so many bytes, for good. False when there is no room for them.
  bool take(std::size_t bytes) { return change(static_cast<std::int64_t>(bytes)); }
  /// The TIN has so many more vertices, or fewer.
  void add_vertices(std::int64_t count) { change(count * static_cast<std::int64_t>(kBytesPerVertex)); }

  /// Whether there was no room once: all is to come to an end then.
  const std::atomic<bool>& is_over() const { return over_; }
  /// What there was no room for.
  std::size_t bytes() const { return static_cast<std::size_t>(bytes_.load()); }

 private:
  static constexpr std::int64_t kStep = std::int64_t{1} << 20;  // between two questions

  bool change(std::int64_t bytes) {
    const std::int64_t now = bytes_.fetch_add(bytes) + bytes;
    if (now > granted_.load()) ask(now);
    return !over_;
  }

  void ask(std::int64_t now) {
    const std::lock_guard lock(asking_);
    if (over_ || now <= granted_) return;
    const std::int64_t wanted = now + kStep;
    if (room_ && !room_(static_cast<std::size_t>(wanted))) {
      over_ = true;
    } else {
      granted_ = wanted;
    }
  }

  const Room room_;
  std::mutex asking_;
  std::atomic<std::int64_t> bytes_{0}, granted_{0};
  std::atomic<bool> over_{false};
};

}  // namespace tin::simplify
