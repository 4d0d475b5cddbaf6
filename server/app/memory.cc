#include "server/app/memory.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>

#include "server/app/scratch.h"

namespace server::app {
namespace {

constexpr std::int64_t kAskEvery_ms = 100;

std::int64_t steady_ms() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
}

}  // namespace

std::uint64_t estimated_bytes(const tin::terrain::Terrain& terrain) {
  const tin::terrain::SourceGrid* grid = terrain.source_grid();
  return terrain.vertex_count() * kBytesPerVertex +
         (grid == nullptr ? 0 : grid->valid.size() * sizeof(std::uint64_t));
}

std::uint64_t estimated_bytes(const tin::terrain::SourceSamples& source) {
  const auto of = [](const auto& array) { return std::uint64_t{array.size()} * sizeof(array[0]); };
  const auto* const scratch = dynamic_cast<const ScratchMemory*>(source.heights().memory());
  const std::uint64_t heights =
      scratch != nullptr ? scratch->in_memory() : std::visit(of, source.heights().stored);
  return heights + of(source.positions()) + of(source.valid());
}

std::uint64_t default_memory_limit() {
  std::uint64_t bytes = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
                        static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  std::uint64_t of_group = 0;
  if (std::ifstream("/sys/fs/cgroup/memory.max") >> of_group) bytes = std::min(bytes, of_group);
  return bytes / 4 * 3;
}

tin::base::Result<MemoryBudget::Lease> MemoryBudget::lease(std::uint64_t bytes) {
  leased_ += bytes;
  Lease lease(*this, bytes);
  if (auto room = check(0); !room) return room.error();
  return lease;
}

tin::base::Result<void> MemoryBudget::check(std::uint64_t bytes) const {
  if (used() + bytes <= limit_) return {};
  return tin::base::error(tin::base::Code::kTooMany,
                          "The terrains on this server take all the memory that it may have at the moment.");
}

namespace {

/// That work takes more than a server may have, whatever else it holds.
tin::base::Error too_large(std::uint64_t bytes, std::uint64_t limit) {
  // Rounded apart, so that the one reads as more than the other.
  return tin::base::error(tin::base::Code::kTooLarge, "This takes " + std::to_string((bytes >> 20) + 1) +
                                                          " MiB of memory and more; the limit here is " +
                                                          std::to_string(limit >> 20) + " MiB.");
}

}  // namespace

tin::base::Result<GrowingLease> GrowingLease::of(MemoryBudget& budget, std::uint64_t fixed) {
  if (fixed > budget.limit()) return too_large(fixed, budget.limit());
  auto lease = budget.lease(fixed);
  if (!lease) return lease.error();
  return GrowingLease(budget, fixed, *std::move(lease));
}

bool GrowingLease::grow_to(std::uint64_t bytes) {
  lease_.resize(fixed_ + bytes);
  if (fixed_ + bytes > budget_->limit()) {
    refusal_ = too_large(fixed_ + bytes, budget_->limit());
  } else if (auto room = budget_->check(0); !room) {
    refusal_ = room.error();
  }
  return !refusal_;
}

std::uint64_t MemoryBudget::used() const {
  return held() + leased_;
}

std::uint64_t MemoryBudget::held() const {
  const std::lock_guard lock(mutex_);
  if (asked_ms_ < 0 || steady_ms() - asked_ms_ >= kAskEvery_ms) {
    held_then_ = held_();
    asked_ms_ = steady_ms();
  }
  return held_then_;
}

}  // namespace server::app
