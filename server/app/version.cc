#include "server/app/version.h"

#include <algorithm>

namespace server::app {
namespace {

constexpr std::size_t kMostKept = 2;
constexpr std::chrono::minutes kKeptFor{5};

}  // namespace

void KeptVersions::keep(const Version& version, Clock::time_point now) {
  Version dropped;  // freed after the lock: it may be the last reference to a whole terrain
  const std::lock_guard lock(mutex_);
  const auto same = std::find_if(kept_.begin(), kept_.end(),
                                 [&](const Kept& kept) { return kept.version.revision == version.revision; });
  if (same != kept_.end()) {
    same->until = now + kKeptFor;
    return;
  }
  if (kept_.size() == kMostKept) {
    const auto oldest = std::min_element(kept_.begin(), kept_.end(),
                                         [](const Kept& a, const Kept& b) { return a.until < b.until; });
    dropped = std::move(oldest->version);
    kept_.erase(oldest);
  }
  kept_.push_back({version, now + kKeptFor});
}

std::optional<Version> KeptVersions::find(std::uint64_t revision, Clock::time_point now) const {
  const std::lock_guard lock(mutex_);
  for (const Kept& kept : kept_) {
    if (kept.version.revision == revision && now <= kept.until) return kept.version;
  }
  return std::nullopt;
}

void KeptVersions::drop_expired(Clock::time_point now) {
  std::vector<Kept> dropped;
  const std::lock_guard lock(mutex_);
  const auto expired =
      std::partition(kept_.begin(), kept_.end(), [&](const Kept& kept) { return now <= kept.until; });
  std::move(expired, kept_.end(), std::back_inserter(dropped));
  kept_.erase(expired, kept_.end());
}

}  // namespace server::app
