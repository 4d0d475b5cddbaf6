#include "tin/terrain/terrain.h"

#include <algorithm>
#include <cmath>

namespace tin::terrain {

using base::Code;
using base::error;
using base::Result;
using exact::Point;
using mesh::VertexSlot;

namespace {

std::string place(std::size_t index) {
  return "/" + std::to_string(index);
}

/// What stands at a position after `count` vertices were put there already.
double merge(Duplicates duplicates, double old_z, double new_z, std::size_t count) {
  switch (duplicates) {
    case Duplicates::kReplace:
      return new_z;
    case Duplicates::kKeep:
      return old_z;
    case Duplicates::kMax:
      return std::max(old_z, new_z);
    case Duplicates::kMin:
      return std::min(old_z, new_z);
    case Duplicates::kMean:
      return old_z + (new_z - old_z) / static_cast<double>(count + 1);
    case Duplicates::kReject:
      break;
  }
  return old_z;
}

Result<void> check_elevation(double z) {
  if (!std::isfinite(z)) return error(Code::kNotFinite, "The elevation is not a finite number.");
  if (std::abs(z) > kMaxElevation) return error(Code::kInvalidValue, "The elevation lies beyond +-1e30.");
  return {};
}

Result<void> check_placement(const Placement& placement) {
  if (!exact::in_lattice(placement.at.x, placement.at.y)) {
    return error(Code::kOutsideLattice, "The position lies outside the lattice.");
  }
  return check_elevation(placement.z);
}

}  // namespace

Result<Terrain> Terrain::build(frame::Frame frame, std::span<const Placement> placements,
                               Duplicates duplicates, base::Progress* progress, unsigned threads) {
  std::vector<Point> points;
  points.reserve(placements.size());
  for (std::size_t i = 0; i < placements.size(); ++i) {
    if (auto fine = check_placement(placements[i]); !fine) {
      return error(fine.error().code, fine.error().message, place(i));
    }
    points.push_back(placements[i].at);
  }
  Terrain terrain(std::move(frame));
  std::vector<VertexSlot> slots;
  if (!terrain.triangulation_.insert_many(points, slots, progress, threads))
    return error(Code::kCancelled, "Cancelled.");
  terrain.z_.resize(terrain.mesh().vertex_slots());
  std::vector<std::uint32_t> stacked(terrain.mesh().vertex_slots(), 0);
  for (std::size_t i = 0; i < placements.size(); ++i) {
    const std::uint32_t slot = slots[i].value();
    if (stacked[slot] == 0) {
      terrain.z_[slot] = placements[i].z;
      terrain.ids_.bind(terrain.next_id_, slots[i]);
      terrain.next_id_ = VertexId(terrain.next_id_.value() + 1);
    } else if (duplicates == Duplicates::kReject) {
      return error(Code::kDuplicatePosition, "A vertex stands at this position already.", place(i));
    } else {
      terrain.z_[slot] = merge(duplicates, terrain.z_[slot], placements[i].z, stacked[slot]);
    }
    ++stacked[slot];
  }
  for (std::uint32_t slot = 1; slot < stacked.size(); ++slot) {
    terrain.hash_.add(terrain.mesh().point(VertexSlot(slot)), terrain.z_[slot]);
  }
  return terrain;
}

Result<Terrain> Terrain::restore(frame::Frame frame, std::span<const Vertex> vertices, VertexId next_id,
                                 unsigned threads) {
  Terrain terrain(std::move(frame));
  std::vector<Point> points;
  points.reserve(vertices.size());
  for (const Vertex& vertex : vertices) {
    if (!check_placement({vertex.at, vertex.z}) || vertex.id.value() == 0 || vertex.id >= next_id) {
      return error(Code::kMalformed, "A stored vertex is invalid.");
    }
    points.push_back(vertex.at);
  }
  std::vector<VertexSlot> slots;
  terrain.triangulation_.insert_many(points, slots, nullptr, threads);
  terrain.z_.resize(terrain.mesh().vertex_slots());
  if (terrain.mesh().vertex_count() != vertices.size())
    return error(Code::kMalformed, "Two stored vertices coincide.");
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (terrain.ids_.slot_of(vertices[i].id))
      return error(Code::kMalformed, "Two stored vertices have one id.");
    terrain.ids_.bind(vertices[i].id, slots[i]);
    terrain.z_[slots[i].value()] = vertices[i].z;
    terrain.hash_.add(vertices[i].at, vertices[i].z);
  }
  terrain.next_id_ = next_id;
  return terrain;
}

Result<Terrain::Applied> Terrain::apply(std::span<const Edit> edits, Duplicates duplicates) {
  Applied applied;
  applied.next_id_before = next_id_;
  for (std::size_t i = 0; i < edits.size(); ++i) {
    auto id =
        std::visit([&](const auto& edit) { return apply_one(edit, duplicates, applied.change); }, edits[i]);
    if (!id) {
      undo(applied);
      return error(id.error().code, id.error().message, place(i));
    }
    applied.ids.push_back(*id);
  }
  close_gaps();
  return applied;
}

/// Canonicity makes going back exact: the inverse steps restore the very mesh.
void Terrain::undo(const Applied& applied) {
  TIN_CHECK(replay(applied.change.inverse()).ok());
  next_id_ = applied.next_id_before;
}

Result<VertexId> Terrain::apply_one(const Insert& edit, Duplicates duplicates, Change& change) {
  if (auto fine = check_placement({edit.at, edit.z}); !fine) return fine.error();
  const auto [slot, fresh] = triangulation_.insert(edit.at);
  if (fresh) {
    const VertexId id = next_id_;
    next_id_ = VertexId(id.value() + 1);
    put(slot, id, {edit.at, edit.z});
    change.steps.push_back({id, std::nullopt, Placement{edit.at, edit.z}});
    return id;
  }
  if (duplicates == Duplicates::kReject) {
    return error(Code::kDuplicatePosition,
                 "Vertex " + std::to_string(id_of(slot).value()) + " stands at this position already.");
  }
  const double merged = merge(duplicates, z(slot), edit.z, 1);
  return merged == z(slot) ? id_of(slot) : apply_one(SetZ{id_of(slot), merged}, duplicates, change);
}

Result<VertexId> Terrain::apply_one(const Remove& edit, Duplicates, Change& change) {
  const auto slot = ids_.slot_of(edit.id);
  if (!slot)
    return error(Code::kUnknownVertex, "There is no vertex " + std::to_string(edit.id.value()) + ".");
  const Step step{edit.id, Placement{mesh().point(*slot), z(*slot)}, std::nullopt};
  TIN_CHECK(take(step));
  change.steps.push_back(step);
  return edit.id;
}

Result<VertexId> Terrain::apply_one(const Move& edit, Duplicates, Change& change) {
  const auto slot = ids_.slot_of(edit.id);
  if (!slot)
    return error(Code::kUnknownVertex, "There is no vertex " + std::to_string(edit.id.value()) + ".");
  const Placement before{mesh().point(*slot), z(*slot)}, after{edit.to, before.z};
  if (auto fine = check_placement(after); !fine) return fine.error();
  if (before == after) return edit.id;
  const Step step{edit.id, before, after};
  if (!take(step))
    return error(Code::kDuplicatePosition, "Another vertex stands at the new position already.");
  change.steps.push_back(step);
  return edit.id;
}

Result<VertexId> Terrain::apply_one(const SetZ& edit, Duplicates, Change& change) {
  const auto slot = ids_.slot_of(edit.id);
  if (!slot)
    return error(Code::kUnknownVertex, "There is no vertex " + std::to_string(edit.id.value()) + ".");
  if (auto fine = check_elevation(edit.z); !fine) return fine.error();
  const Placement before{mesh().point(*slot), z(*slot)};
  const Step step{edit.id, before, Placement{before.at, edit.z}};
  TIN_CHECK(take(step));
  change.steps.push_back(step);
  return edit.id;
}

Result<void> Terrain::replay(const Change& change) {
  for (std::size_t i = 0; i < change.steps.size(); ++i) {
    if (take(change.steps[i])) continue;
    for (std::size_t back = i; back > 0; --back) {
      const Step& done = change.steps[back - 1];
      TIN_CHECK(take({done.id, done.after, done.before}));
    }
    return error(Code::kConflict, "The change does not fit the terrain's vertices.", place(i));
  }
  close_gaps();
  return {};
}

/// Performs one step if the present set allows it; otherwise changes nothing.
bool Terrain::take(const Step& step) {
  const auto slot = ids_.slot_of(step.id);
  if (slot.has_value() != step.before.has_value()) return false;
  if (slot && Placement{mesh().point(*slot), z(*slot)} != *step.before) return false;
  if (step.after && (!check_placement(*step.after) || step.id.value() == 0)) return false;
  if (step.before && step.after && step.before->at == step.after->at) {
    hash_.subtract(step.before->at, step.before->z);
    hash_.add(step.after->at, step.after->z);
    z_[slot->value()] = step.after->z;
    return true;
  }
  if (step.after) {
    const auto [to, fresh] = triangulation_.insert(step.after->at);
    if (!fresh) return false;
    if (slot) drop(*slot, step.id);
    put(to, step.id, *step.after);
    if (step.id >= next_id_) next_id_ = VertexId(step.id.value() + 1);
  } else if (slot) {
    drop(*slot, step.id);
  }
  return true;
}

void Terrain::put(VertexSlot slot, VertexId id, const Placement& placement) {
  if (slot.value() >= z_.size()) z_.resize(slot.value() + 1);
  z_[slot.value()] = placement.z;
  ids_.bind(id, slot);
  hash_.add(placement.at, placement.z);
}

void Terrain::drop(VertexSlot slot, VertexId id) {
  hash_.subtract(mesh().point(slot), z(slot));
  ids_.unbind(id);
  triangulation_.remove(slot);
}

/// After many removals: gives the memory of their slots back, and stores along the curve what is left.
void Terrain::close_gaps() {
  constexpr std::size_t kWorthIt = 20'000;  // slots; fewer take less than two megabytes
  const std::size_t slots = mesh().vertex_slots();
  if (slots < kWorthIt || vertex_count() > slots / 2) return;
  const mesh::Renumbering moved = triangulation_.compact();
  std::vector<double> z(mesh().vertex_slots());
  for (std::size_t slot = 0; slot < z_.size(); ++slot) {
    const std::uint32_t to = moved.vertices[slot].value();
    if (to != mesh::kNone) z[to] = z_[slot];
  }
  z_ = std::move(z);
  ids_.renumber(moved);
}

std::optional<Vertex> Terrain::vertex(VertexId id) const {
  const auto slot = ids_.slot_of(id);
  if (!slot) return std::nullopt;
  return Vertex{id, mesh().point(*slot), z(*slot)};
}

std::vector<Vertex> Terrain::vertices_by_id(std::span<const VertexId> without) const {
  std::vector<Vertex> vertices;
  vertices.reserve(vertex_count());
  auto skip = without.begin();
  for (auto id = ids_.first_from(VertexId(0)); id; id = ids_.first_from(VertexId(id->value() + 1))) {
    while (skip != without.end() && *skip < *id) ++skip;
    if (skip == without.end() || *skip != *id) vertices.push_back(*vertex(*id));
  }
  return vertices;
}

Terrain Terrain::replaced(std::span<const VertexId> removed, std::span<const Vertex> added, unsigned threads) const {
  auto vertices = vertices_by_id(removed);
  vertices.insert(vertices.end(), added.begin(), added.end());
  const VertexId next = added.empty() ? next_id_ : VertexId(added.back().id.value() + 1);
  auto rest = restore(frame_, vertices, next, threads);
  TIN_CHECK(rest.ok());
  rest->set_source_grid(source_grid_);
  rest->set_amendments(amendments_);
  return std::move(*rest);
}

std::optional<Box> Terrain::bounds() const {
  if (vertex_count() == 0) return std::nullopt;
  Box box{{exact::kLatticeHalf, exact::kLatticeHalf}, {-exact::kLatticeHalf, -exact::kLatticeHalf}};
  for (std::uint32_t i = 1; i < mesh().vertex_slots(); ++i) {
    if (!mesh().is_alive(VertexSlot(i))) continue;
    const Point p = mesh().point(VertexSlot(i));
    box.min = {std::min(box.min.x, p.x), std::min(box.min.y, p.y)};
    box.max = {std::max(box.max.x, p.x), std::max(box.max.y, p.y)};
  }
  return box;
}

std::optional<ZRange> Terrain::z_range() const {
  std::optional<ZRange> range;
  for (std::uint32_t i = 1; i < mesh().vertex_slots(); ++i) {
    if (!mesh().is_alive(VertexSlot(i))) continue;
    if (!range) range = ZRange{z_[i], z_[i]};
    *range = {std::min(range->min, z_[i]), std::max(range->max, z_[i])};
  }
  return range;
}

}  // namespace tin::terrain
