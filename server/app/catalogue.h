// The TINs that are served, by id, each with its place in the store.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/app/memory.h"
#include "server/app/scratch_space.h"
#include "server/app/tin.h"
#include "server/config.h"
#include "server/store/store.h"
#include "tin/base/result.h"

namespace server::app {

/// Thread-safe.
class Catalogue {
 public:
  /// Loads every TIN of the store. Temporary files of large rasters go to `scratch`; empty: there are none.
  /// Errors: kStorage, kMalformed, kUnsupported: then the data needs a person.
  static tin::base::Result<std::unique_ptr<Catalogue>> open(std::unique_ptr<store::Store> store,
                                                            const LimitConfig& limits,
                                                            const HistoryConfig& history = {},
                                                            const std::filesystem::path& scratch = {});

  /// By id.
  std::vector<std::shared_ptr<Tin>> list() const;
  /// Errors: kNotFound.
  tin::base::Result<std::shared_ptr<Tin>> find(std::string_view id) const;

  struct NewTin {
    std::optional<std::string> id;  // nothing: one is made up
    std::string title;
    tin::terrain::Terrain terrain;
    tin::terrain::Duplicates duplicates = tin::terrain::Duplicates::kReplace;
    OpenResolution open_resolution;
    store::Pieces source;  // bytes of what it was made of, as its amendments say; empty: none
  };
  /// Stores and serves a new TIN, at revision 1. Errors: kConflict (id taken), kTooLarge (vertices), kTooMany
  /// (TINs, memory), kStorage.
  tin::base::Result<std::shared_ptr<Tin>> create(NewTin tin);
  /// Whether create() would refuse for the id or the number of TINs: asked before long work. Errors: as
  /// create().
  tin::base::Result<void> check_room(const std::optional<std::string>& id) const;
  /// The memory that terrains may take.
  MemoryBudget& memory() { return memory_; }
  const MemoryBudget& memory() const { return memory_; }
  /// Where rasters lie that are larger than what of them may be in memory.
  const ScratchSpace& scratch() const { return scratch_; }
  /// Errors: kNotFound, kStorage.
  tin::base::Result<void> remove(std::string_view id);

  store::Store& store() { return *store_; }

 private:
  Catalogue(std::unique_ptr<store::Store> store, const LimitConfig& limits, const HistoryConfig& history,
            const std::filesystem::path& scratch)
      : store_(std::move(store)),
        limits_(limits),
        memory_(limits.memory_bytes == 0 ? default_memory_limit()
                                         : static_cast<std::uint64_t>(limits.memory_bytes),
                [this] { return held_bytes(); }),
        scratch_({scratch, static_cast<std::uint64_t>(limits.raster_memory_bytes),
                  static_cast<std::uint64_t>(limits.scratch_bytes)}),
        history_(history) {}
  std::uint64_t held_bytes() const;
  tin::base::Result<void> load(const store::TinRecord& record);
  void sweep(const std::stop_token& stop);
  void sweep_once(const std::stop_token& stop);
  void keep_up(Tin& tin);
  void forget_answers();
  tin::base::Result<void> check_room_locked(const std::optional<std::string>& id) const;

  std::unique_ptr<store::Store> store_;
  const LimitConfig limits_;
  MemoryBudget memory_;
  const ScratchSpace scratch_;
  const HistoryConfig history_;
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Tin>, std::less<>> tins_;
  std::set<std::string, std::less<>> being_created_;
  std::condition_variable_any stopping_;
  std::jthread sweeper_;  // last, so that it ends first
};

/// Unix time in milliseconds.
std::int64_t now_ms();

}  // namespace server::app
