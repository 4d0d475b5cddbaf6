// What a TIN takes of the memory: its present terrain, those before it that somebody still reads, and its
// source while a simplification works with it.
#include "server/app/memory.h"
#include "server/app/tin.h"

namespace server::app {

std::uint64_t Tin::held_bytes() const {
  if (const auto now =
          try_read([](const Terrain& terrain, std::uint64_t) { return estimated_bytes(terrain); })) {
    present_bytes_ = *now;
  }
  std::uint64_t bytes = present_bytes_;
  const std::lock_guard lock(past_mutex_);
  std::erase_if(past_, [](const auto& past) { return past.expired(); });
  for (const auto& past : past_) {
    if (const auto terrain = past.lock()) bytes += estimated_bytes(*terrain);
  }
  if (const auto source = source_in_hand_.lock()) bytes += estimated_bytes(*source);
  return bytes;
}

std::uint64_t Tin::copy_bytes() const {
  const std::shared_lock lock(mutex_);
  if (!terrain_ || versions_out_->load(std::memory_order_relaxed) == 0) return 0;
  return estimated_bytes(*terrain_);
}

void Tin::expect_past() {
  const std::lock_guard lock(past_mutex_);
  std::erase_if(past_, [](const auto& past) { return past.expired(); });
  past_.reserve(past_.size() + 1);
}

/// Only the writer adds to past_, so the room that expect_past() made is there still.
void Tin::remember_past() noexcept {
  const std::lock_guard lock(past_mutex_);
  if (terrain_) past_.emplace_back(terrain_);
}

}  // namespace server::app
