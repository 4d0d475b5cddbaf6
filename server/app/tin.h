// One TIN being served: its writer, and its readers.
//
// Short reads (an elevation, a page) run under a shared lock. Long ones (an export, a simplification) take a
// version(): an immutable terrain that costs nothing as long as nobody edits. The first edit while a version
// is out copies the terrain, at memory speed and beside the readers, and goes on with the copy.
//
// Writes queue; whoever is first carries out what waits as one batch: applies it, takes it back, commits it,
// and performs it again for readers to see. So nobody ever sees what may be lost, and readers wait for no
// disk.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "server/app/changed_areas.h"
#include "server/app/fair_mutex.h"
#include "server/app/memory.h"
#include "server/app/scratch_space.h"
#include "server/app/thinning.h"
#include "server/app/version.h"
#include "server/app/world_edit.h"
#include "server/app/write.h"
#include "server/app/write_queue.h"
#include "server/store/store.h"
#include "tin/base/result.h"
#include "tin/terrain/source_samples.h"
#include "tin/terrain/terrain.h"

namespace server::app {

/// What became of a simplification.
struct Landed {
  std::uint64_t revision = 0;
  std::size_t vertices_left = 0;
  bool edited_meanwhile = false;  // others edited the TIN since the version that was seen
};

/// What has to become of `now` where a thinning that was chosen for an earlier version would make `landed` of it.
using Mend = std::function<tin::base::Result<Thinning>(const tin::terrain::Terrain& now,
                                                       const tin::terrain::Terrain& landed)>;

/// What the document of a TIN says of its content, all at one revision.
struct Summary {
  std::uint64_t revision = 0;
  std::size_t vertex_count = 0;
  std::size_t triangle_count = 0;
  std::optional<tin::terrain::Box> bounds;
  std::optional<tin::terrain::ZRange> z_range;
  std::string digest;
  tin::frame::Frame frame;
  std::shared_ptr<const tin::terrain::SourceGrid> source;  // null for points
};

/// All that a Tin begins with.
struct TinState {
  store::TinRecord record;
  tin::terrain::Terrain terrain;
  tin::terrain::Duplicates duplicates = tin::terrain::Duplicates::kReplace;
  OpenResolution open_resolution;
  std::uint64_t revision = 1;
  std::uint64_t steps_since_checkpoint = 0;
};

/// Thread-safe.
class Tin {
 public:
  Tin(TinState state, store::Store& store, std::size_t max_vertices);

  const std::string& id() const { return record_.id; }
  std::string title() const;
  /// Tells this TIN from a later one of the same id.
  std::int64_t created_ms() const { return record_.created_ms; }
  tin::terrain::Duplicates duplicates() const { return duplicates_; }

  /// Calls f(const Terrain&, revision) under the shared lock: for what takes well under a millisecond per
  /// thousand vertices asked.
  template <class F>
  auto read(F&& f) const {
    const std::shared_lock lock(mutex_);
    require_terrain();
    return f(std::as_const(*terrain_), revision_);
  }
  /// The same if it can be done without waiting for a writer; nothing otherwise.
  template <class F>
  auto try_read(F&& f) const
      -> std::optional<decltype(f(std::declval<const tin::terrain::Terrain&>(), std::uint64_t{}))> {
    const std::shared_lock lock(mutex_, std::try_to_lock);
    if (!lock || !terrain_) return std::nullopt;
    return f(std::as_const(*terrain_), revision_);
  }
  Version version() const;
  Summary summary() const;

  /// What the present terrain takes, those of versions that are out still, and the source while somebody has
  /// it in hand; as far as known without waiting.
  std::uint64_t held_bytes() const;
  /// What the next edit will copy because a version is out.
  std::uint64_t copy_bytes() const;
  /// Where its latest revisions changed it.
  const ChangedAreas& changed_areas() const { return changed_areas_; }

  /// Remembers a version for a while, so that pages can go on from it when edits arrive; see page_version().
  void keep_for_pages(const Version& version) { kept_.keep(version); }
  /// Frees what was remembered too long ago. To be called now and then.
  void drop_expired() { kept_.drop_expired(); }
  /// The version of that revision: the present one or one kept for pages. Errors: kGone.
  tin::base::Result<Version> page_version(std::uint64_t revision) const;

  /// The present revision: what it holds is durable.
  std::uint64_t revision() const;

  /// Applies all edits or none; durable when it returns. Under a key that was used before: what was answered
  /// then. Errors: kPrecondition; kInvalidValue (the key came with another request before); as
  /// frame::to_lattice and Terrain::apply, at "/i"; kTooLarge (vertices per TIN); kTooMany (no memory);
  /// kNotFound (retired); kStorage; kNoSpace.
  tin::base::Result<Edited> edit(std::span<const WorldEdit> edits, const Terms& terms);

  /// Undoes one revision, as a revision. Errors: kNotFound (no such revision), kGone (it is no longer kept),
  /// kConflict (later ones changed what it changed), and as edit().
  /// What it takes meanwhile is taken from `memory`, if that is given.
  tin::base::Result<Edited> revert(std::uint64_t revision, const Terms& terms,
                                   MemoryBudget* memory = nullptr);

  /// What was answered under the key, if anything was. Errors: kInvalidValue (the key came with another
  /// request before), kStorage.
  tin::base::Result<std::optional<Edited>> answered(const RequestKey& key) const;

  /// A vertex as a revision left it: nothing when it was gone then, or when that is not known any more.
  std::optional<tin::terrain::Vertex> vertex_after(std::uint64_t revision, VertexId id) const;

  /// Takes a simplification in as one revision; vertices that are gone meanwhile, or changed since `seen`,
  /// and positions where another stands by now, stay out of it. What is large, or was edited meanwhile, is
  /// prepared beside readers and editors. `mend` says what has to become of a version that was edited
  /// meanwhile instead, if anything has to. Errors: kTooLarge (vertices per TIN), kNotFound (retired),
  /// kStorage; those of `mend`.
  tin::base::Result<Landed> land(const Version& seen, const Thinning& thinning,
                                 const store::RevisionInfo& info, const Mend& mend = {});

  /// The samples that the TIN was made of, as they were then; null where none are kept. Read from the store
  /// when nobody else has them in hand, and given back when the last one lets go; where `space` says if they
  /// are many. Errors: kNotFound (retired), kStorage, kMalformed. Throws NoScratch.
  tin::base::Result<std::shared_ptr<const tin::terrain::SourceSamples>> source(
      const ScratchSpace& space) const;
  /// The same as bytes, for another TIN; empty where none are kept. Giving them may fail with kNotFound
  /// (retired), kStorage. Requires: this outlives them.
  store::Pieces source_bytes() const;

  /// Errors: kNotFound (retired), kStorage, kNoSpace.
  tin::base::Result<void> rename(std::string_view title);

  /// Removes the TIN from the store. Those who hold it still may read it; edits get kNotFound, so that none
  /// of them, and no job that ends late, can reach a later TIN of the same id. Errors: kNotFound (it is gone
  /// already), kStorage.
  tin::base::Result<void> retire();

  /// Steps in the journal that a start would have to replay.
  std::uint64_t steps_since_checkpoint() const { return steps_since_checkpoint_.load(); }
  /// Brings the checkpoint up to the present revision, out of the last one and the journal: the terrain is
  /// not asked, so that nobody waits. Not by two threads at once. Errors: kNotFound (retired), kStorage,
  /// kNoSpace.
  tin::base::Result<void> write_checkpoint();

  /// What the store has of a TIN. Errors: kNotFound, kStorage, kMalformed, kUnsupported, kConflict.
  static tin::base::Result<TinState> load(store::Store& store, std::string_view id);
  /// A state as a checkpoint, and back.
  static std::string encode(const tin::terrain::Terrain& terrain, tin::terrain::Duplicates duplicates,
                            const OpenResolution& open_resolution, std::uint64_t revision);
  static tin::base::Result<TinState> decode(const store::TinRecord& record, std::string_view checkpoint);

 private:
  using Terrain = tin::terrain::Terrain;
  using Lock = std::unique_lock<FairSharedMutex>;
  struct Batch;

  // Above so many steps, doing a batch again costs readers more than waiting for the disk with it.
  static constexpr std::size_t kDoneTwice = 256;

  tin::base::Result<void> read_source(const store::MeasuredSink& sink) const;

  tin::base::Error too_many_vertices() const;
  tin::base::Result<Terrain::Applied> apply(Terrain& terrain, const LatticeEdits& edits, Write& write) const;
  void require_terrain() const;  // throws if it was lost

  // The writer's turn: one thread at a time, see WriteQueue.
  tin::base::Result<Edited> submit(Write& write);
  void carry_out(std::span<Write* const> writes);
  bool settled_before(Write& write);
  void carry_out_together(std::span<Write* const> writes);
  void apply_all(std::span<Write* const> writes, Batch& batch);
  void apply_one(Write& write, Batch& batch);
  void take_back(const Batch& batch);
  void perform(const Batch& batch);
  void publish(Batch& batch, const tin::base::Result<void>& durable);
  void fit_and_apply(Write& write);
  void take_over(Write& write);
  store::Entry entry_of(const Write& write, const tin::terrain::Change& change, const Edited& edited) const;
  tin::base::Result<void> commit(std::span<const store::Entry> entries);
  Lock exclusive();
  void replace_terrain(std::shared_ptr<Terrain> terrain);
  void expect_past();             // before remember_past(): makes room for it
  void remember_past() noexcept;  // that the present terrain goes, so that held_bytes() counts it as long as it is held
  void reload() noexcept;

  tin::base::Result<Landed> land_in_place(const Version& seen, const Thinning& thinning, const Mend& mend,
                                          const Terms& terms);
  tin::base::Result<Edited> replay_aside(const tin::terrain::Change& change, const Terms& terms,
                                         MemoryBudget* memory);
  tin::base::Error explain_conflict(std::uint64_t revision, const tin::terrain::Change& inverse,
                                    const tin::base::Error& conflict);

  store::TinRecord record_;  // its title under title_mutex_, the rest constant
  mutable std::mutex title_mutex_;
  const tin::terrain::Duplicates duplicates_;
  store::Store& store_;
  const std::size_t max_vertices_;

  // Changed in the writer's turn and under mutex_: readers hold it shared, the writer reads without it.
  mutable FairSharedMutex mutex_;
  std::shared_ptr<Terrain> terrain_;  // null: lost for want of memory, to be loaded again
  mutable std::shared_ptr<std::atomic<int>> versions_out_;  // of terrain_
  mutable std::mutex past_mutex_;
  mutable std::vector<std::weak_ptr<const Terrain>> past_;  // those that the present one took the place of
  mutable std::atomic<std::uint64_t> present_bytes_{0};     // as last seen
  OpenResolution open_resolution_;
  std::uint64_t revision_;
  bool retired_ = false;

  mutable std::mutex cache_mutex_;
  mutable std::optional<Summary> summary_;
  KeptVersions kept_;
  ChangedAreas changed_areas_;
  mutable std::mutex source_mutex_;  // held while the source is read, so that it is read once
  mutable std::weak_ptr<const tin::terrain::SourceSamples> source_;
  mutable std::weak_ptr<const tin::terrain::SourceSamples> source_in_hand_;  // the same, under past_mutex_
  std::atomic<std::uint64_t> steps_since_checkpoint_;
  WriteQueue<Write> writes_;
};

}  // namespace server::app
