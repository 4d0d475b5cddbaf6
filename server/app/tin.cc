#include "server/app/tin.h"

#include <algorithm>
#include <cmath>

#include "server/gdal/crs.h"
#include "server/obs/log.h"
#include "tin/codec/change.h"
#include "tin/codec/checkpoint.h"

namespace server::app {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;
using tin::terrain::Change;
using tin::terrain::Edit;
using tin::terrain::Terrain;

namespace {

constexpr std::size_t kKeptVersions = 2;
constexpr std::chrono::minutes kKeptFor{5};
constexpr std::size_t kRebuildShare =
    4;  // removing more than 1/4 of the vertices: building what stays is faster

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

}  // namespace

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
  terrain_ = std::make_shared<Terrain>(*terrain_);
  versions_out_ = std::make_shared<std::atomic<int>>(0);
}

Summary Tin::summary() const {
  const std::shared_lock lock(mutex_);
  const std::lock_guard cache(cache_mutex_);
  if (!summary_ || summary_->revision != revision_) {
    summary_ = Summary{revision_,          terrain_->vertex_count(), terrain_->triangle_count(),
                       terrain_->bounds(), terrain_->z_range(),      terrain_->digest()};
  }
  return *summary_;
}

void Tin::keep_for_pages(const Version& version) {
  const auto now = std::chrono::steady_clock::now();
  std::vector<Kept> dropped;  // destroyed after the lock: a last reference frees a whole terrain
  const std::lock_guard lock(cache_mutex_);
  std::erase_if(kept_, [&](Kept& kept) {
    const bool drop = kept.until < now || kept.version.revision == version.revision;
    if (drop) dropped.push_back(std::move(kept));
    return drop;
  });
  if (kept_.size() == kKeptVersions) {
    dropped.push_back(std::move(kept_.front()));
    kept_.erase(kept_.begin());
  }
  kept_.push_back({version, now + kKeptFor});
}

Result<Version> Tin::page_version(std::uint64_t revision) const {
  if (Version present = version(); present.revision == revision) return present;
  const std::lock_guard lock(cache_mutex_);
  for (const Kept& kept : kept_) {
    if (kept.version.revision == revision) return kept.version;
  }
  return error(Code::kGone, "Revision " + std::to_string(revision) +
                                " is no longer kept; start again from the first page.");
}

Result<Edited> Tin::edit(std::span<const WorldEdit> edits, std::optional<std::uint64_t> expected,
                         const store::RevisionInfo& info) {
  const std::unique_lock lock(mutex_);
  if (retired_) return gone(id());
  if (expected && *expected != revision_) {
    return error(Code::kPrecondition, "The TIN is at revision " + std::to_string(revision_) + ", not " +
                                          std::to_string(*expected) + ".");
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
  Result<void> kept;
  if (terrain.vertex_count() > max_vertices_) {
    kept = error(Code::kTooLarge, "A TIN may have at most " + std::to_string(max_vertices_) + " vertices.");
  } else if (fitted) {
    kept = store_.put_checkpoint(id(), revision_, empty_checkpoint);
  }
  if (kept) kept = journal(applied->change, info);
  if (!kept) {
    TIN_CHECK(terrain.replay(applied->change.inverse()).ok());
    return kept.error();
  }
  if (fitted) {
    terrain_ = std::move(fitted);
    versions_out_ = std::make_shared<std::atomic<int>>(0);
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

/// Writes the next revision, and counts it when it is durable.
Result<void> Tin::journal(const Change& change, const store::RevisionInfo& info) {
  auto durable = store_.append(id(), revision_ + 1, tin::codec::encode_change(change), info);
  if (durable) ++revision_;
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

Result<Edited> Tin::remove_vertices(const Version& seen, std::span<const VertexId> ids,
                                    const store::RevisionInfo& info) {
  // Most of a large removal is done beside the readers, on the version seen, and counts if that is still the
  // present one.
  std::shared_ptr<Terrain> rebuilt;
  if (ids.size() > seen.terrain->vertex_count() / kRebuildShare) {
    rebuilt = std::make_shared<Terrain>(seen.terrain->without(ids));
  }
  const std::unique_lock lock(mutex_);
  if (retired_) return gone(id());
  Edited edited;
  Change change;
  for (const VertexId id : ids) {
    const auto now = terrain_->vertex(id), then = seen.terrain->vertex(id);
    if (!now || !then || now->at != then->at || now->z != then->z) continue;
    change.steps.push_back({id, tin::terrain::Placement{now->at, now->z}, std::nullopt});
    edited.ids.push_back(id);
  }
  if (change.steps.empty()) {
    edited.revision = revision_;
    return edited;
  }
  const bool unchanged = seen.revision == revision_;
  if (auto durable = journal(change, info); !durable) return durable.error();
  if (rebuilt && unchanged) {
    terrain_ = std::move(rebuilt);
    versions_out_ = std::make_shared<std::atomic<int>>(0);
    // Only a start made quicker: the revision is durable already.
    const auto kept =
        store_.put_checkpoint(id(), revision_, encode(*terrain_, duplicates_, std::nullopt, revision_));
    if (!kept) obs::log_warning("checkpoint_failed", {{"tin", id()}, {"message", kept.error().message}});
  } else {
    own_terrain();
    TIN_CHECK(terrain_->replay(change).ok());
  }
  edited.revision = revision_;
  return edited;
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
  return TinState{record, std::move(*terrain), checkpoint->duplicates, checkpoint->open_resolution,
                  checkpoint->revision};
}

}  // namespace server::app
