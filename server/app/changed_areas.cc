#include "server/app/changed_areas.h"

#include <algorithm>

namespace server::app {
namespace {

/// Older ones are forgotten: about 200 KB.
constexpr std::size_t kMostNoted = 4096;

bool meet(const tin::terrain::Box& a, const tin::terrain::Box& b) {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y;
}

}  // namespace

void ChangedAreas::note(std::uint64_t revision, const std::optional<tin::query::TouchedArea>& area) {
  const std::lock_guard lock(mutex_);
  noted_.push_back({revision, area});
  if (noted_.size() > kMostNoted) noted_.pop_front();
}

bool ChangedAreas::may_differ(std::uint64_t one, std::uint64_t other, const tin::terrain::Box& box, bool hull) const {
  const auto [first, last] = std::minmax(one, other);
  const std::lock_guard lock(mutex_);
  std::uint64_t expected = first + 1;
  for (auto at = std::lower_bound(noted_.begin(), noted_.end(), expected, [](const Noted& n, std::uint64_t r) { return n.revision < r; });
       at != noted_.end() && at->revision <= last; ++at, ++expected) {
    if (at->revision != expected || !at->area || meet(at->area->box, box) || (hull && at->area->hull)) return true;
  }
  return expected <= last;
}

}  // namespace server::app
