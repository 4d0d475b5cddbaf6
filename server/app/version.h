// Immutable terrains for long readers, and those that are kept for the pages of a walk.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "tin/terrain/terrain.h"

namespace server::app {

/// An immutable terrain at one revision; keep it for as long as you read it, and no longer.
struct Version {
  std::shared_ptr<const tin::terrain::Terrain> terrain;
  std::uint64_t revision = 0;
};

/// The versions that pages may go on from, each for five minutes after it was last asked for, two at most.
/// Thread-safe.
class KeptVersions {
 public:
  using Clock = std::chrono::steady_clock;

  void keep(const Version& version, Clock::time_point now = Clock::now());
  /// The version of that revision, if it is kept still.
  std::optional<Version> find(std::uint64_t revision, Clock::time_point now = Clock::now()) const;
  /// Frees the memory of those whose time is over.
  void drop_expired(Clock::time_point now = Clock::now());

 private:
  struct Kept {
    Version version;
    Clock::time_point until;
  };
  mutable std::mutex mutex_;
  std::vector<Kept> kept_;
};

}  // namespace server::app
