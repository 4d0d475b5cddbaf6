// How much memory terrains take, and how much they may: an estimate that is quick to make and errs upwards.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>

#include "tin/base/result.h"
#include "tin/terrain/source_samples.h"
#include "tin/terrain/terrain.h"

namespace server::app {

/// Of one vertex with its triangles, elevation, id and location structures; measured, rounded up.
inline constexpr std::uint64_t kBytesPerVertex = 160;

/// What a terrain takes, its source's mask included.
std::uint64_t estimated_bytes(const tin::terrain::Terrain& terrain);

/// What the samples of a source take that are in hand.
std::uint64_t estimated_bytes(const tin::terrain::SourceSamples& source);

/// Three quarters of what the machine, or the group of processes this one is in, may have.
std::uint64_t default_memory_limit();

/// What is held, what work under way has reserved, and the limit of both. Thread-safe.
class MemoryBudget {
 public:
  /// `held` tells what terrains take now; it is asked ten times a second at most.
  MemoryBudget(std::uint64_t limit, std::function<std::uint64_t()> held)
      : limit_(limit), held_(std::move(held)) {}

  /// A part of the memory for work under way, until the end of the scope.
  class Lease {
   public:
    Lease(MemoryBudget& budget, std::uint64_t bytes) : budget_(&budget), bytes_(bytes) {}
    Lease(Lease&& other) noexcept : budget_(std::exchange(other.budget_, nullptr)), bytes_(other.bytes_) {}
    Lease& operator=(Lease&&) = delete;
    /// Takes so much from now on, whether there is room or not: see check().
    void resize(std::uint64_t bytes) {
      budget_->leased_ += bytes - bytes_;
      bytes_ = bytes;
    }
    ~Lease() {
      if (budget_ != nullptr) budget_->leased_ -= bytes_;
    }

   private:
    MemoryBudget* budget_;
    std::uint64_t bytes_;
  };

  /// Errors: kTooMany.
  tin::base::Result<Lease> lease(std::uint64_t bytes);
  /// Whether there is room for so much more. Errors: kTooMany.
  tin::base::Result<void> check(std::uint64_t bytes) const;

  /// What terrains and work under way take.
  std::uint64_t used() const;
  std::uint64_t limit() const { return limit_; }

 private:
  std::uint64_t held() const;

  const std::uint64_t limit_;
  const std::function<std::uint64_t()> held_;
  std::atomic<std::uint64_t> leased_{0};
  mutable std::mutex mutex_;
  mutable std::int64_t asked_ms_ = -1;
  mutable std::uint64_t held_then_ = 0;
};

/// A lease for work that finds out on its way how much it takes. For one thread at a time.
class GrowingLease {
 public:
  /// `fixed` is what it takes in any case. Errors: kTooLarge (it is above the limit alone), kTooMany.
  static tin::base::Result<GrowingLease> of(MemoryBudget& budget, std::uint64_t fixed);

  /// Whether there is room for so many bytes beside what is fixed; from then on they are taken, or what could
  /// not be had is remembered.
  bool grow_to(std::uint64_t bytes);
  /// Why there was no room.
  const std::optional<tin::base::Error>& refusal() const { return refusal_; }

 private:
  GrowingLease(MemoryBudget& budget, std::uint64_t fixed, MemoryBudget::Lease lease)
      : budget_(&budget), fixed_(fixed), lease_(std::move(lease)) {}

  MemoryBudget* budget_;
  std::uint64_t fixed_;
  MemoryBudget::Lease lease_;
  std::optional<tin::base::Error> refusal_;
};

}  // namespace server::app
