#include "server/app/world_edit.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "server/gdal/crs.h"
#include "tin/base/check.h"
#include "tin/query/within.h"

namespace server::app {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;
using tin::terrain::Duplicates;
using tin::terrain::Edit;
using tin::terrain::Terrain;

namespace {

std::string place(std::size_t index) {
  return "/" + std::to_string(index);
}

}  // namespace

bool inserts_any(std::span<const WorldEdit> edits) {
  return std::any_of(edits.begin(), edits.end(),
                     [](const WorldEdit& edit) { return std::holds_alternative<InsertAt>(edit); });
}

Result<LatticeEdits> to_lattice(std::span<const WorldEdit> edits, const tin::frame::Frame& frame) {
  LatticeEdits all;
  std::vector<Edit>& out = all.edits;
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
    } else if (const auto* within = std::get_if<RemoveWithin>(&edits[i])) {
      LatticeEdits::Area& area = all.areas.emplace_back(LatticeEdits::Area{i, {}});
      for (const auto& [x, y] : within->polygon) {
        const auto corner = snapped(x, y);
        if (!corner) return corner.error();
        area.ring.push_back(*corner);
      }
    } else {
      out.emplace_back(std::get<tin::terrain::Remove>(edits[i]));
    }
  }
  return all;
}

namespace {

/// Several Terrain::apply() as one that can be taken back.
class Sequence {
 public:
  Sequence(Terrain& terrain, Duplicates duplicates) : terrain_(terrain), duplicates_(duplicates) {
    all_.next_id_before = terrain.next_id();
  }

  /// On error all of it is taken back.
  Result<void> add(std::span<const Edit> edits) {
    auto applied = terrain_.apply(edits, duplicates_);
    if (!applied) {
      take_back();
      return applied.error();
    }
    all_.ids.insert(all_.ids.end(), applied->ids.begin(), applied->ids.end());
    all_.change.steps.insert(all_.change.steps.end(), applied->change.steps.begin(),
                             applied->change.steps.end());
    return {};
  }
  void take_back() { terrain_.undo(all_); }
  Terrain::Applied finish() { return std::move(all_); }

 private:
  Terrain& terrain_;
  const Duplicates duplicates_;
  Terrain::Applied all_;
};

/// "/3" of a part as the place of that edit among all.
tin::base::Error shifted(tin::base::Error problem, std::size_t by) {
  if (problem.where.size() > 1) problem.where = place(std::stoull(problem.where.substr(1)) + by);
  return problem;
}

}  // namespace

Result<Terrain::Applied> apply(Terrain& terrain, const LatticeEdits& edits, Duplicates duplicates,
                               std::size_t most_within, std::vector<AreaResult>& areas) {
  areas.clear();
  if (edits.areas.empty()) return terrain.apply(edits.edits, duplicates);
  Sequence sequence(terrain, duplicates);
  std::size_t done = 0, left = most_within;
  for (std::size_t a = 0; a <= edits.areas.size(); ++a) {
    const std::size_t end = a == edits.areas.size() ? edits.edits.size() : edits.areas[a].index - a;
    if (auto fine = sequence.add(std::span(edits.edits).subspan(done, end - done)); !fine)
      return shifted(fine.error(), done + a);
    done = end;
    if (a == edits.areas.size()) break;
    const auto within = tin::query::vertices_within(terrain, edits.areas[a].ring, left);
    if (within.size() > left) {
      sequence.take_back();
      return error(Code::kTooLarge,
                   "The polygons of a request may hold at most " + std::to_string(most_within) + " vertices.",
                   place(edits.areas[a].index));
    }
    left -= within.size();
    areas.emplace_back(edits.areas[a].index, within.size());
    std::vector<Edit> removals;
    for (const VertexId id : within) removals.emplace_back(tin::terrain::Remove{id});
    TIN_CHECK(sequence.add(removals).ok());
  }
  return sequence.finish();
}

Result<std::shared_ptr<Terrain>> fit_frame(const tin::frame::Frame& open,
                                           const std::array<double, 2>& resolution,
                                           std::span<const WorldEdit> edits) {
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
  if (!open.crs.empty()) {
    const auto crs = gdal::read_crs(open.crs);
    if (!crs) return crs.error();
    scale = crs->scale;
  }
  auto fitted = tin::frame::fit_points(*extent, scale, resolution[0], resolution[1]);
  if (!fitted) return fitted.error();
  tin::frame::Frame frame = open;
  frame.x = fitted->x;
  frame.y = fitted->y;
  return std::make_shared<Terrain>(frame);
}

}  // namespace server::app
