#include "server/app/tin.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "server/app/threads.h"
#include "tin/codec/change.h"
#include "tin/codec/checkpoint.h"
#include "tin/codec/source.h"
#include "tin/terrain/vertex_set.h"

namespace server::app {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;
using tin::terrain::Terrain;

Tin::Tin(TinState state, store::Store& store, std::size_t max_vertices)
    : record_(std::move(state.record)),
      duplicates_(state.duplicates),
      store_(store),
      max_vertices_(max_vertices),
      terrain_(std::make_shared<Terrain>(std::move(state.terrain))),
      versions_out_(std::make_shared<std::atomic<int>>(0)),
      open_resolution_(state.open_resolution),
      revision_(state.revision),
      steps_since_checkpoint_(state.steps_since_checkpoint),
      writes_([this](std::span<Write* const> writes) { carry_out(writes); }) {}

std::string Tin::title() const {
  const std::lock_guard lock(title_mutex_);
  return record_.title;
}

std::uint64_t Tin::revision() const {
  const std::shared_lock lock(mutex_);
  return revision_;
}

Version Tin::version() const {
  const std::shared_lock lock(mutex_);
  require_terrain();
  versions_out_->fetch_add(1, std::memory_order_relaxed);
  // The count, not the pointer's, tells the writer that the last reader is done: its release makes the reads
  // happen before.
  auto done = [terrain = terrain_, out = versions_out_](const Terrain*) {
    out->fetch_sub(1, std::memory_order_release);
  };
  return {std::shared_ptr<const Terrain>(terrain_.get(), std::move(done)), revision_};
}

Summary Tin::summary() const {
  const std::shared_lock lock(mutex_);
  require_terrain();
  const std::lock_guard cache(cache_mutex_);
  if (!summary_ || summary_->revision != revision_) {
    const Terrain& t = *terrain_;
    summary_ = Summary{revision_,   t.vertex_count(), t.triangle_count(), t.bounds(),
                       t.z_range(), t.digest(),       t.frame(),          t.shared_source_grid()};
  }
  return *summary_;
}

Result<Version> Tin::page_version(std::uint64_t revision) const {
  if (Version present = version(); present.revision == revision) return present;
  if (auto kept = kept_.find(revision)) return *kept;
  return error(Code::kGone, "Revision " + std::to_string(revision) +
                                " is no longer kept; start again from the first page.");
}

Result<Edited> Tin::edit(std::span<const WorldEdit> edits, const Terms& terms) {
  Write write(terms);
  write.weight = edits.size();
  const auto [frame, open] = [&] {
    const std::shared_lock lock(mutex_);
    require_terrain();
    return std::pair(terrain_->frame(), open_resolution_.has_value());
  }();
  LatticeEdits
      lattice_edits;  // made here, where nobody waits; while the frame is open only when it is our turn
  if (open && inserts_any(edits)) {
    write.alone = true;
    write.first_vertices = edits;
  } else if (open) {
    write.apply = [&](Terrain& terrain) -> Result<Terrain::Applied> {
      const auto made = to_lattice(edits, terrain.frame());
      if (!made) return made.error();
      return apply(terrain, *made, write);
    };
  } else {
    auto made = to_lattice(edits, frame);
    if (!made) return made.error();
    lattice_edits = std::move(*made);
    // What an area holds is known only then: so it is not done twice, and readers wait for the disk.
    if (!lattice_edits.areas.empty()) write.weight += kDoneTwice;
    write.apply = [&](Terrain& terrain) { return apply(terrain, lattice_edits, write); };
  }
  return submit(write);
}

Result<Terrain::Applied> Tin::apply(Terrain& terrain, const LatticeEdits& edits, Write& write) const {
  return app::apply(terrain, edits, duplicates_, write.terms.most_within, write.areas);
}

std::optional<tin::terrain::Vertex> Tin::vertex_after(std::uint64_t revision, VertexId vertex) const {
  const auto [present, now] = read([&](const Terrain& terrain, std::uint64_t at) {
    return std::pair(at, at == revision ? terrain.vertex(vertex) : std::nullopt);
  });
  if (present == revision) return now;
  const auto rows = store_.read_journal(id(), {.first = revision, .last = revision});
  if (!rows || rows->empty()) return std::nullopt;
  const auto change = tin::codec::decode_change(rows->front().record);
  if (!change) return std::nullopt;
  const auto last = std::find_if(change->steps.rbegin(), change->steps.rend(),
                                 [&](const tin::terrain::Step& step) { return step.id == vertex; });
  if (last == change->steps.rend() || !last->after) return std::nullopt;
  return tin::terrain::Vertex{vertex, last->after->at, last->after->z};
}

Result<void> Tin::rename(std::string_view title) {
  Write write{Terms{}};
  write.instead = [&]() -> Result<void> {
    if (auto stored = store_.update_title(id(), title); !stored) return stored;
    const std::lock_guard lock(title_mutex_);
    record_.title = title;
    return {};
  };
  const auto done = submit(write);
  return done ? Result<void>() : Result<void>(done.error());
}

Result<void> Tin::retire() {
  Write write{Terms{}};
  write.instead = [&] {
    auto removed = store_.remove_tin(id());
    const Lock lock(mutex_);  // for source_bytes()
    retired_ = removed.ok();
    return removed;
  };
  const auto done = submit(write);
  return done ? Result<void>() : Result<void>(done.error());
}

Result<void> Tin::read_source(const store::MeasuredSink& sink) const {
  auto done = store_.read_source(id(), sink);
  const std::shared_lock lock(mutex_);
  if (retired_)
    return error(Code::kNotFound,
                 "The TIN \"" + id() + "\" has been deleted.");  // what was read may be another TIN's by now
  return done;
}

store::Pieces Tin::source_bytes() const {
  const auto kind = read([](const Terrain& terrain, std::uint64_t) { return terrain.amendments().kind(); });
  if (kind == tin::terrain::SourceKind::kNone) return {};
  return [this](const store::Sink& sink) {
    return read_source([&sink](std::string_view piece, std::uint64_t) { return sink(piece); });
  };
}

Result<std::shared_ptr<const tin::terrain::SourceSamples>> Tin::source(const ScratchSpace& space) const {
  using Source = std::shared_ptr<const tin::terrain::SourceSamples>;
  const auto [kind, grid] = read([](const Terrain& terrain, std::uint64_t) {
    return std::pair(terrain.amendments().kind(), terrain.shared_source_grid());
  });
  if (kind == tin::terrain::SourceKind::kNone) return Source();
  const std::lock_guard reading(source_mutex_);
  if (Source present = source_.lock()) return present;
  // With the memory that its heights lie in, which outlives them so.
  struct Held {
    std::unique_ptr<ScratchMemory> memory;
    std::optional<tin::terrain::SourceSamples> samples;
  };
  const auto held = std::make_shared<Held>(Held{space.memory(), std::nullopt});
  tin::base::Array<char> bytes(held->memory.get());
  const tin::base::Pace pace(held->memory.get());
  const auto done = read_source([&](std::string_view piece, std::uint64_t whole) -> Result<void> {
    if (bytes.empty()) bytes.reserve(whole);
    bytes.insert(bytes.end(), piece.begin(), piece.end());
    pace.touched(1, piece.size());
    return {};
  });
  if (!done) return done.error();
  auto decoded = tin::codec::decode_source({bytes.data(), bytes.size()},
                                           kind == tin::terrain::SourceKind::kRaster ? grid : nullptr,
                                           held->memory.get());
  if (!decoded) return decoded.error();
  held->samples.emplace(*std::move(decoded));
  Source source(held, &*held->samples);
  source_ = source;
  const std::lock_guard counted(past_mutex_);
  source_in_hand_ = source;
  return source;
}

Result<void> Tin::write_checkpoint() {
  // What became of the source's samples depends on meshes that are gone: it is asked of the terrain, as is
  // the digest.
  const auto [revision, digest, amendments] = read([](const Terrain& terrain, std::uint64_t present) {
    return std::tuple(present, terrain.digest(), terrain.amendments());
  });
  auto stored = store_.load(id());
  if (!stored) return stored.error();
  if (revision <= stored->checkpoint_revision) return {};
  auto checkpoint = tin::codec::decode_checkpoint(stored->checkpoint);
  if (!checkpoint) return checkpoint.error();
  stored->checkpoint = {};
  tin::terrain::VertexSet set(std::move(checkpoint->vertices), checkpoint->next_id);
  std::uint64_t steps = 0;
  for (const store::JournalRow& row : stored->journal) {
    if (row.revision > revision) break;
    const auto change = tin::codec::decode_change(row.record);
    if (!change) return change.error();
    if (auto replayed = set.replay(*change); !replayed) return replayed;
    steps += change->steps.size();
  }
  checkpoint->vertices = set.vertices();
  checkpoint->next_id = set.next_id();
  checkpoint->revision = revision;
  checkpoint->digest = tin::terrain::digest_of(checkpoint->vertices, checkpoint->frame);
  checkpoint->amendments = amendments;
  if (checkpoint->digest != digest)
    return error(Code::kInternal, "The journal does not lead to the terrain that is served.");
  auto put = store_.put_checkpoint(id(), revision, tin::codec::encode_checkpoint(*checkpoint));
  if (put) steps_since_checkpoint_ -= steps;
  return put;
}

Result<TinState> Tin::load(store::Store& store, std::string_view id) {
  auto stored = store.load(id);
  if (!stored) return stored.error();
  auto state = decode(stored->tin, stored->checkpoint);
  if (!state) return state.error();
  for (const store::JournalRow& row : stored->journal) {
    const auto change = tin::codec::decode_change(row.record);
    if (!change) return change.error();
    if (auto replayed = state->terrain.replay(*change); !replayed) return replayed.error();
    state->terrain.amend(*change);
    state->revision = row.revision;
    state->steps_since_checkpoint += change->steps.size();
  }
  return state;
}

std::string Tin::encode(const Terrain& terrain, tin::terrain::Duplicates duplicates,
                        const OpenResolution& open_resolution, std::uint64_t revision) {
  tin::codec::Checkpoint checkpoint;
  checkpoint.revision = revision;
  checkpoint.digest = terrain.digest();
  checkpoint.next_id = terrain.next_id();
  checkpoint.duplicates = duplicates;
  checkpoint.frame = terrain.frame();
  checkpoint.open_resolution = open_resolution;
  checkpoint.vertices = terrain.vertices_by_id();
  checkpoint.grid = terrain.shared_source_grid();
  checkpoint.amendments = terrain.amendments();
  return tin::codec::encode_checkpoint(checkpoint);
}

Result<TinState> Tin::decode(const store::TinRecord& record, std::string_view bytes) {
  auto checkpoint = tin::codec::decode_checkpoint(bytes);
  if (!checkpoint) return checkpoint.error();
  auto terrain = Terrain::restore(checkpoint->frame, checkpoint->vertices, checkpoint->next_id, engine_threads());
  if (!terrain) return terrain.error();
  if (terrain->digest() != checkpoint->digest) {
    return error(Code::kStorage, "The checkpoint's digest is not that of its vertices.");
  }
  terrain->set_source_grid(checkpoint->grid);
  terrain->set_amendments(std::move(checkpoint->amendments));
  return TinState{record, std::move(*terrain), checkpoint->duplicates, checkpoint->open_resolution,
                  checkpoint->revision};
}

}  // namespace server::app
