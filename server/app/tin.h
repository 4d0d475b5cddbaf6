// One TIN being served: its writer, and its readers.
//
// Short reads (an elevation, a page) run under a shared lock. Long ones (an export, a simplification) take a
// version(): an immutable terrain that costs nothing as long as nobody edits. The first edit while a version
// is out copies the terrain, at memory speed, and goes on with the copy; so no reader holds up an editor for
// longer than that. An edit is journaled durably before readers see it.
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

#include "server/app/fair_mutex.h"
#include "server/app/version.h"
#include "server/store/store.h"
#include "tin/base/result.h"
#include "tin/terrain/source_samples.h"
#include "tin/terrain/terrain.h"

namespace server::app {

using VertexId = tin::terrain::VertexId;

/// Edits with positions in the TIN's CRS. The frame turns them into lattice points.
struct InsertAt {
  double x = 0, y = 0, z = 0;
};
struct MoveTo {
  VertexId id;
  double x = 0, y = 0;
};
using WorldEdit = std::variant<InsertAt, tin::terrain::Remove, MoveTo, tin::terrain::SetZ>;

/// What becomes of a TIN's frame when its first vertices arrive: fitted to them with these lattice steps (0:
/// chosen).
using OpenResolution = std::optional<std::array<double, 2>>;

struct Edited {
  std::uint64_t revision = 0;
  std::vector<VertexId> ids;  // one per edit
};

/// What a simplification does to the vertices of the version that it saw.
struct Thinning {
  std::vector<VertexId> removed;                  // ascending
  std::vector<tin::terrain::Placement> inserted;  // samples that become vertices again, by position
  std::vector<tin::terrain::Vertex> reset;        // vertices that get another height, by id

  bool empty() const { return removed.empty() && inserted.empty() && reset.empty(); }
};

/// `terrain` after it, built anew.
tin::terrain::Terrain thinned(const tin::terrain::Terrain& terrain, const Thinning& thinning);

/// What became of it.
struct Landed {
  std::uint64_t revision = 0;
  std::size_t vertices_left = 0;
  bool edited_meanwhile = false;  // others edited the TIN since the version that was seen
};

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
};

/// Thread-safe.
class Tin {
 public:
  Tin(TinState state, store::Store& store, std::size_t max_vertices);

  const std::string& id() const { return record_.id; }
  const std::string& title() const { return record_.title; }
  /// Tells this TIN from a later one of the same id.
  std::int64_t created_ms() const { return record_.created_ms; }
  tin::terrain::Duplicates duplicates() const { return duplicates_; }

  /// Calls f(const Terrain&, revision) under the shared lock: for what takes well under a millisecond per
  /// thousand vertices asked.
  template <class F>
  auto read(F&& f) const {
    const std::shared_lock lock(mutex_);
    return f(std::as_const(*terrain_), revision_);
  }
  /// The same if it can be done without waiting for a writer; nothing otherwise.
  template <class F>
  auto try_read(F&& f) const
      -> std::optional<decltype(f(std::declval<const tin::terrain::Terrain&>(), std::uint64_t{}))> {
    const std::shared_lock lock(mutex_, std::try_to_lock);
    if (!lock) return std::nullopt;
    return f(std::as_const(*terrain_), revision_);
  }
  Version version() const;
  Summary summary() const;

  /// What the present terrain takes, and those of versions that are out still; as far as known without
  /// waiting.
  std::uint64_t held_bytes() const;
  /// What the next edit will copy because a version is out.
  std::uint64_t copy_bytes() const;

  /// Remembers a version for a while, so that pages can go on from it when edits arrive; see page_version().
  void keep_for_pages(const Version& version) { kept_.keep(version); }
  /// Frees what was remembered too long ago. To be called now and then.
  void drop_expired() { kept_.drop_expired(); }
  /// The version of that revision: the present one or one kept for pages. Errors: kGone.
  tin::base::Result<Version> page_version(std::uint64_t revision) const;

  /// Applies all edits or none; durable when it returns. `expected`: the present revision must be one of
  /// these, if any are given. Errors: kPrecondition; as frame::to_lattice and Terrain::apply, at "/i";
  /// kTooLarge (vertices per TIN); kNotFound (retired); kStorage.
  tin::base::Result<Edited> edit(std::span<const WorldEdit> edits, std::span<const std::uint64_t> expected,
                                 const store::RevisionInfo& info);

  /// Takes a simplification in as one revision; vertices that are gone meanwhile, or changed since `seen`,
  /// and positions where another stands by now, stay out of it. A large one is prepared beside readers and
  /// editors. Errors: kTooLarge (vertices per TIN), kNotFound (retired), kStorage.
  tin::base::Result<Landed> land(const Version& seen, const Thinning& thinning,
                                 const store::RevisionInfo& info);

  /// The samples that the TIN was made of, as they were then; null where none are kept. Read from the store
  /// when nobody else has them in hand, and given back when the last one lets go. Errors: kNotFound
  /// (retired), kStorage, kMalformed.
  tin::base::Result<std::shared_ptr<const tin::terrain::SourceSamples>> source() const;
  /// The same as bytes, for another TIN; empty where none are kept. Errors: kNotFound (retired), kStorage.
  tin::base::Result<std::string> source_bytes() const;

  /// Removes the TIN from the store. Those who hold it still may read it; edits get kNotFound, so that none
  /// of them, and no job that ends late, can reach a later TIN of the same id. Errors: kNotFound (it is gone
  /// already), kStorage.
  tin::base::Result<void> retire();

  /// A state as a checkpoint, and back.
  static std::string encode(const tin::terrain::Terrain& terrain, tin::terrain::Duplicates duplicates,
                            const OpenResolution& open_resolution, std::uint64_t revision);
  static tin::base::Result<TinState> decode(const store::TinRecord& record, std::string_view checkpoint);

 private:
  using Terrain = tin::terrain::Terrain;

  tin::base::Error too_many_vertices() const;
  void remember_past();  // so that held_bytes() counts it
  void own_terrain();    // copies it if a version is out; with mutex_ held
  tin::base::Result<std::shared_ptr<Terrain>> fit_open_frame(std::span<const WorldEdit> edits) const;
  tin::base::Result<void> journal(const tin::terrain::Change& change, const store::RevisionInfo& info);
  void replace_terrain(std::shared_ptr<Terrain> terrain);
  tin::base::Result<Landed> land_in_place(const Version& seen, const Thinning& thinning,
                                          const store::RevisionInfo& info);
  void write_checkpoint();

  const store::TinRecord record_;
  const tin::terrain::Duplicates duplicates_;
  store::Store& store_;
  const std::size_t max_vertices_;

  mutable FairSharedMutex mutex_;
  std::shared_ptr<Terrain> terrain_;
  mutable std::shared_ptr<std::atomic<int>> versions_out_;  // of terrain_
  mutable std::mutex past_mutex_;
  mutable std::vector<std::weak_ptr<const Terrain>> past_;  // those that the present one was copied from
  mutable std::atomic<std::uint64_t> present_bytes_{0};     // as last seen
  OpenResolution open_resolution_;
  std::uint64_t revision_;
  bool retired_ = false;

  mutable std::mutex cache_mutex_;
  mutable std::optional<Summary> summary_;
  KeptVersions kept_;

  mutable std::mutex source_mutex_;  // held while the source is read, so that it is read once
  mutable std::weak_ptr<const tin::terrain::SourceSamples> source_;
};

}  // namespace server::app
