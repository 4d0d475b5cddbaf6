// Which parts of a TIN its latest revisions changed, so that what was made of the others need not be made again.
#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>

#include "tin/query/touched.h"

namespace server::app {

/// Thread-safe. A revision that nobody noted counts as one that changed everything.
class ChangedAreas {
 public:
  /// That `revision` changed no more than this; nothing: perhaps everything.
  void note(std::uint64_t revision, const std::optional<tin::query::TouchedArea>& area);

  /// Whether the surface in `box` may differ between two revisions; with `hull` also where the outline does.
  bool may_differ(std::uint64_t one, std::uint64_t other, const tin::terrain::Box& box, bool hull) const;

 private:
  struct Noted {
    std::uint64_t revision;
    std::optional<tin::query::TouchedArea> area;
  };
  mutable std::mutex mutex_;
  std::deque<Noted> noted_;  // ascending
};

}  // namespace server::app
