#include "server/app/tin.h"

#include <algorithm>
#include <cmath>

#include "server/app/memory.h"
#include "server/gdal/crs.h"
#include "server/obs/log.h"
#include "server/obs/metrics.h"
#include "tin/codec/change.h"
#include "tin/codec/checkpoint.h"
#include "tin/codec/source.h"

namespace server::app {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;
using tin::terrain::Change;
using tin::terrain::Edit;
using tin::terrain::Terrain;

namespace {

constexpr std::size_t kSmallThinning = 20'000;  // vertices that are changed one by one while readers wait
constexpr int kAttempts = 3;                    // to land a large thinning without making editors wait

std::string place(std::size_t index) {
  return "/" + std::to_string(index);
}

tin::base::Error gone(const std::string& id) {
  return error(Code::kNotFound, "The TIN \"" + id + "\" has been deleted.");
}

Result<std::vector<Edit>> to_lattice(std::span<const WorldEdit> edits, const tin::frame::Frame& frame) {
  std::vector<Edit> out;
  out.reserve(edits.size());
  for (std::size_t i = 0; i < edits.size(); ++i) {
    const auto snapped = [&](double x, double y) {
      auto at = frame.to_lattice(x, y);
      return at ? at : Result<tin::exact::Point>(error(at.error().code, at.error().message, place(i)));
    };
    if (const auto* insert = std::get_if<InsertAt>(&edits[i])) {
      const auto at = snapped(insert->x, insert->y);
      if (!at) return at.error();
      out.emplace_back(tin::terrain::Insert{*at, insert->z});
    } else if (const auto* move = std::get_if<MoveTo>(&edits[i])) {
      const auto to = snapped(move->x, move->y);
      if (!to) return to.error();
      out.emplace_back(tin::terrain::Move{move->id, *to});
    } else if (const auto* set = std::get_if<tin::terrain::SetZ>(&edits[i])) {
      out.emplace_back(*set);
    } else {
      out.emplace_back(std::get<tin::terrain::Remove>(edits[i]));
    }
  }
  return out;
}

/// Takes an applied edit back unless it was kept, also when something throws.
class UndoUnlessKept {
 public:
  UndoUnlessKept(Terrain& terrain, const Terrain::Applied& applied) : terrain_(terrain), applied_(applied) {}
  ~UndoUnlessKept() {
    if (!kept_) terrain_.undo(applied_);
  }
  UndoUnlessKept(const UndoUnlessKept&) = delete;
  UndoUnlessKept& operator=(const UndoUnlessKept&) = delete;
  void keep() { kept_ = true; }

 private:
  Terrain& terrain_;
  const Terrain::Applied& applied_;
  bool kept_ = false;
};

/// A simplification as it fits the present vertices.
struct Fitting {
  std::vector<VertexId> removed;              // ascending
  std::vector<tin::terrain::Vertex> changed;  // with their new heights
  std::vector<tin::terrain::Vertex> added;    // with ids of their own
  Change change;
};

bool is_unchanged(const Terrain& seen, const Terrain& now, VertexId id) {
  const auto present = now.vertex(id), then = seen.vertex(id);
  return present && then && present->at == then->at && present->z == then->z;
}

bool is_free(const Terrain& terrain, tin::exact::Point p) {
  const auto& mesh = terrain.mesh();
  if (mesh.dimension() < 2) {
    const auto line = mesh.line();
    return std::none_of(line.begin(), line.end(), [&](auto v) { return mesh.point(v) == p; });
  }
  return terrain.triangulation().locate(p).kind != tin::delaunay::Location::Kind::kOnVertex;
}

/// What of a thinning of `seen` is possible now. Vertices go before others come: a position is free by then.
Fitting fit(const Terrain& seen, const Terrain& now, const Thinning& thinning) {
  using tin::terrain::Placement;
  Fitting fitting;
  fitting.change.cause = tin::terrain::Cause::kSimplification;
  auto& steps = fitting.change.steps;
  for (const VertexId id : thinning.removed) {
    if (!is_unchanged(seen, now, id)) continue;
    const auto vertex = now.vertex(id);
    fitting.removed.push_back(id);
    steps.push_back({id, Placement{vertex->at, vertex->z}, std::nullopt});
  }
  for (const tin::terrain::Vertex& vertex : thinning.reset) {
    if (!is_unchanged(seen, now, vertex.id)) continue;
    steps.push_back(
        {vertex.id, Placement{vertex.at, now.vertex(vertex.id)->z}, Placement{vertex.at, vertex.z}});
    fitting.changed.push_back(vertex);
  }
  VertexId next = now.next_id();
  for (const Placement& sample : thinning.inserted) {
    if (!is_free(now, sample.at)) continue;
    fitting.added.push_back({next, sample.at, sample.z});
    steps.push_back({next, std::nullopt, sample});
    next = VertexId(next.value() + 1);
  }
  return fitting;
}

/// `terrain` with the fitting done, built anew.
Terrain rebuilt(const Terrain& terrain, const Fitting& fitting) {
  Terrain rest = terrain.replaced(fitting.removed, fitting.added);
  Change heights;
  for (const tin::terrain::Vertex& vertex : fitting.changed) {
    heights.steps.push_back({vertex.id, tin::terrain::Placement{vertex.at, rest.vertex(vertex.id)->z},
                             tin::terrain::Placement{vertex.at, vertex.z}});
  }
  TIN_CHECK(rest.replay(heights).ok());
  rest.amend(fitting.change);
  return rest;
}

}  // namespace

Terrain thinned(const Terrain& terrain, const Thinning& thinning) {
  return rebuilt(terrain, fit(terrain, terrain, thinning));
}

Tin::Tin(TinState state, store::Store& store, std::size_t max_vertices)
    : record_(std::move(state.record)),
      duplicates_(state.duplicates),
      store_(store),
      max_vertices_(max_vertices),
      terrain_(std::make_shared<Terrain>(std::move(state.terrain))),
      versions_out_(std::make_shared<std::atomic<int>>(0)),
      open_resolution_(state.open_resolution),
      revision_(state.revision) {}

Version Tin::version() const {
  const std::shared_lock lock(mutex_);
  versions_out_->fetch_add(1, std::memory_order_relaxed);
  // The count, not the pointer's, tells the writer that the last reader is done: its release makes the reads
  // happen before.
  auto done = [terrain = terrain_, out = versions_out_](const Terrain*) {
    out->fetch_sub(1, std::memory_order_release);
  };
  return {std::shared_ptr<const Terrain>(terrain_.get(), std::move(done)), revision_};
}

void Tin::own_terrain() {
  if (versions_out_->load(std::memory_order_acquire) == 0) return;
  remember_past();
  terrain_ = std::make_shared<Terrain>(*terrain_);
  versions_out_ = std::make_shared<std::atomic<int>>(0);
}

void Tin::remember_past() {
  const std::lock_guard lock(past_mutex_);
  past_.emplace_back(terrain_);
}

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
  return bytes;
}

std::uint64_t Tin::copy_bytes() const {
  const std::shared_lock lock(mutex_);
  return versions_out_->load(std::memory_order_relaxed) == 0 ? 0 : estimated_bytes(*terrain_);
}

void Tin::replace_terrain(std::shared_ptr<Terrain> terrain) {
  if (versions_out_->load(std::memory_order_acquire) != 0) remember_past();
  terrain_ = std::move(terrain);
  versions_out_ = std::make_shared<std::atomic<int>>(0);
}

Summary Tin::summary() const {
  const std::shared_lock lock(mutex_);
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

Result<Edited> Tin::edit(std::span<const WorldEdit> edits, std::span<const std::uint64_t> expected,
                         const store::RevisionInfo& info) {
  const std::unique_lock lock(mutex_);
  if (retired_) return gone(id());
  if (!expected.empty() && std::find(expected.begin(), expected.end(), revision_) == expected.end()) {
    return error(Code::kPrecondition, "The TIN is at revision " + std::to_string(revision_) + " by now.");
  }
  // The first vertices of an open frame go into an empty terrain beside the present one: a refused edit
  // leaves the frame open.
  std::shared_ptr<Terrain> fitted;
  std::string empty_checkpoint;
  const bool inserts = std::any_of(edits.begin(), edits.end(),
                                   [](const WorldEdit& e) { return std::holds_alternative<InsertAt>(e); });
  if (open_resolution_ && inserts) {
    auto empty = fit_open_frame(edits);
    if (!empty) return empty.error();
    fitted = std::move(*empty);
    empty_checkpoint = encode(*fitted, duplicates_, std::nullopt, revision_);
  }
  const auto lattice_edits = to_lattice(edits, fitted ? fitted->frame() : terrain_->frame());
  if (!lattice_edits) return lattice_edits.error();
  if (!fitted) own_terrain();
  Terrain& terrain = fitted ? *fitted : *terrain_;
  auto applied = terrain.apply(*lattice_edits, duplicates_);
  if (!applied) return applied.error();
  if (applied->change.steps.empty()) return Edited{revision_, std::move(applied->ids)};
  UndoUnlessKept undo(terrain, *applied);
  Result<void> kept;
  if (terrain.vertex_count() > max_vertices_) {
    kept = too_many_vertices();
  } else if (fitted) {
    kept = store_.put_checkpoint(id(), revision_, empty_checkpoint);
  }
  if (kept) kept = journal(applied->change, info);
  if (!kept) return kept.error();
  undo.keep();
  terrain.amend(applied->change);
  if (fitted) {
    replace_terrain(std::move(fitted));
    open_resolution_.reset();
  }
  return Edited{revision_, std::move(applied->ids)};
}

Result<void> Tin::retire() {
  const std::unique_lock lock(mutex_);
  if (retired_) return gone(id());
  auto removed = store_.remove_tin(id());
  retired_ = removed.ok();
  return removed;
}

tin::base::Error Tin::too_many_vertices() const {
  return error(Code::kTooLarge, "A TIN may have at most " + std::to_string(max_vertices_) + " vertices.");
}

/// Writes the next revision, and counts it when it is durable.
Result<void> Tin::journal(const Change& change, const store::RevisionInfo& info) {
  auto durable = store_.append(id(), revision_ + 1, tin::codec::encode_change(change), info);
  if (durable) {
    ++revision_;
    obs::metrics().revisions.fetch_add(1, std::memory_order_relaxed);
  }
  return durable;
}

/// The first vertices arrive: an empty terrain in a frame that is fitted to them.
Result<std::shared_ptr<Terrain>> Tin::fit_open_frame(std::span<const WorldEdit> edits) const {
  std::optional<tin::frame::Extent> extent;
  for (std::size_t i = 0; i < edits.size(); ++i) {
    const auto* insert = std::get_if<InsertAt>(&edits[i]);
    if (insert == nullptr) continue;
    if (!std::isfinite(insert->x) || !std::isfinite(insert->y)) {
      return error(Code::kNotFinite, "A coordinate is not a finite number.", place(i));
    }
    if (!extent) extent = tin::frame::Extent{insert->x, insert->y, insert->x, insert->y};
    *extent = {std::min(extent->min_x, insert->x), std::min(extent->min_y, insert->y),
               std::max(extent->max_x, insert->x), std::max(extent->max_y, insert->y)};
  }
  tin::frame::GroundScale scale;
  const auto& present = terrain_->frame();
  if (!present.crs.empty()) {
    const auto crs = gdal::read_crs(present.crs);
    if (!crs) return crs.error();
    scale = crs->scale;
  }
  auto fitted = tin::frame::fit_points(*extent, scale, (*open_resolution_)[0], (*open_resolution_)[1]);
  if (!fitted) return fitted.error();
  tin::frame::Frame frame = present;
  frame.x = fitted->x;
  frame.y = fitted->y;
  return std::make_shared<Terrain>(frame);
}

Result<Landed> Tin::land(const Version& seen, const Thinning& thinning, const store::RevisionInfo& info) {
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const Version base = attempt == 0 ? seen : version();
    const Fitting fitting = fit(*seen.terrain, *base.terrain, thinning);
    if (fitting.change.steps.size() <= kSmallThinning) break;
    auto rest = std::make_shared<Terrain>(rebuilt(*base.terrain, fitting));
    if (rest->vertex_count() > max_vertices_) return too_many_vertices();
    std::unique_lock lock(mutex_);
    if (retired_) return gone(id());
    if (base.revision != revision_) continue;
    if (auto durable = journal(fitting.change, info); !durable) return durable.error();
    replace_terrain(std::move(rest));
    const Landed landed{revision_, terrain_->vertex_count(), base.revision != seen.revision};
    lock.unlock();
    write_checkpoint();
    return landed;
  }
  return land_in_place(seen, thinning, info);
}

/// Few vertices, or editors who were quicker each time: now they wait.
Result<Landed> Tin::land_in_place(const Version& seen, const Thinning& thinning,
                                  const store::RevisionInfo& info) {
  std::unique_lock lock(mutex_);
  if (retired_) return gone(id());
  const bool edited_meanwhile = seen.revision != revision_;
  const Fitting fitting = fit(*seen.terrain, *terrain_, thinning);
  const Change& change = fitting.change;
  if (terrain_->vertex_count() - fitting.removed.size() + fitting.added.size() > max_vertices_)
    return too_many_vertices();
  if (!change.steps.empty()) {
    own_terrain();
    if (auto durable = journal(change, info); !durable) return durable.error();
    TIN_CHECK(terrain_->replay(change).ok());
    terrain_->amend(change);
  }
  const Landed landed{revision_, terrain_->vertex_count(), edited_meanwhile};
  lock.unlock();
  if (change.steps.size() > kSmallThinning) write_checkpoint();
  return landed;
}

Result<std::string> Tin::source_bytes() const {
  auto bytes = store_.load_source(id());
  const std::shared_lock lock(mutex_);
  if (retired_) return gone(id());  // what was read may be another TIN's by now
  return bytes;
}

Result<std::shared_ptr<const tin::terrain::SourceSamples>> Tin::source() const {
  using Source = std::shared_ptr<const tin::terrain::SourceSamples>;
  const auto [kind, grid] = read([](const Terrain& terrain, std::uint64_t) {
    return std::pair(terrain.amendments().kind(), terrain.shared_source_grid());
  });
  if (kind == tin::terrain::SourceKind::kNone) return Source();
  const std::lock_guard reading(source_mutex_);
  if (Source present = source_.lock()) return present;
  const auto bytes = source_bytes();
  if (!bytes) return bytes.error();
  auto decoded =
      tin::codec::decode_source(*bytes, kind == tin::terrain::SourceKind::kRaster ? grid : nullptr);
  if (!decoded) return decoded.error();
  Source source = std::make_shared<const tin::terrain::SourceSamples>(*std::move(decoded));
  source_ = source;
  return source;
}

/// Makes the next start quicker. The journal holds everything, so failing is no loss.
void Tin::write_checkpoint() {
  const Version present = version();
  const auto kept = store_.put_checkpoint(
      id(), present.revision, encode(*present.terrain, duplicates_, std::nullopt, present.revision));
  if (!kept) obs::log_warning("checkpoint_failed", {{"tin", id()}, {"message", kept.error().message}});
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
  auto terrain = Terrain::restore(checkpoint->frame, checkpoint->vertices, checkpoint->next_id);
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
