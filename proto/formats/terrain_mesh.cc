#include "proto/formats/terrain_mesh.h"

#include <algorithm>
#include <limits>

#include "tin/query/void_triangles.h"

namespace proto::formats {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;
using tin::mesh::VertexSlot;
using tin::query::TriangleView;
using tin::query::TriangleWalk;

namespace {
constexpr std::size_t kChunk = 1024;
constexpr std::uint32_t kAbsent = 0xffffffff;
constexpr std::uint32_t kPresent = 0;  // before the vertices are numbered
}  // namespace

TerrainMesh::TerrainMesh(const tin::terrain::Terrain& terrain, MeshRequest request)
    : terrain_(terrain), request_(std::move(request)) {
  const auto& frame = terrain.frame();
  head_.title = request_.title;
  head_.crs = request_.convert ? request_.crs : frame.crs;
  head_.geographic = request_.geographic;
  head_.unit_m = request_.unit_m;
  head_.vertical_unit = frame.vertical_unit;
  head_.vertical_unit_m = frame.vertical_unit_m;
  if (!request_.convert) head_.frame = frame;
}

Result<std::unique_ptr<TerrainMesh>> TerrainMesh::create(const tin::terrain::Terrain& terrain,
                                                         MeshRequest request) {
  std::unique_ptr<TerrainMesh> mesh(new TerrainMesh(terrain, std::move(request)));
  if (auto prepared = mesh->prepare(); !prepared) return prepared.error();
  mesh->rewind();
  return mesh;
}

Result<void> TerrainMesh::prepare() {
  number_.assign(terrain_.mesh().vertex_slots(), request_.box ? kAbsent : kPresent);
  const bool masks = request_.voids == Voids::kKeep && tin::query::has_voids(terrain_);
  head_.triangles = terrain_.triangle_count();
  if (request_.box || masks) {
    if (auto chosen = choose_triangles(); !chosen) return chosen.error();
  }
  return choose_vertices();
}

/// Sets the bits of all triangles, and marks the vertices of those that stay.
Result<void> TerrainMesh::choose_triangles() {
  head_.triangles = head_.hidden = 0;
  kept_.reserve(2 * terrain_.triangle_count());
  TriangleWalk walk(terrain_, {});
  std::vector<TriangleView> batch;
  for (bool more = true; more;) {
    if (request_.check) {
      if (auto going = request_.check(); !going) return going.error();
    }
    batch.clear();
    while (batch.size() < kChunk) {
      const auto triangle = walk.next();
      more = triangle.has_value();
      if (!more) break;
      batch.push_back(*triangle);
    }
    take(batch);
  }
  return {};
}

void TerrainMesh::take(std::span<const TriangleView> triangles) {
  std::vector<Position> corners;
  if (request_.box) {
    for (const TriangleView& triangle : triangles) {
      for (const VertexSlot slot : triangle.slots) corners.push_back(own(slot));
    }
    convert(corners);
  }
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const TriangleView& triangle = triangles[i];
    const bool kept =
        !request_.box || touches({corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]}, *request_.box);
    const bool hidden =
        kept && request_.voids == Voids::kKeep && tin::query::over_void(terrain_, triangle.slots);
    kept_.push_back(kept);
    kept_.push_back(hidden);
    if (!kept) continue;
    ++(hidden ? head_.hidden : head_.triangles);
    for (const VertexSlot slot : triangle.slots) number_[slot.value()] = kPresent;
  }
}

/// Numbers the vertices that stay, and measures them.
Result<void> TerrainMesh::choose_vertices() {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  head_.low = {kInfinite, kInfinite, kInfinite};
  head_.high = {-kInfinite, -kInfinite, -kInfinite};
  std::uint32_t count = 0;
  next_ = terrain_.ids().first_from(VertexId(0));
  std::vector<VertexSlot> slots;
  std::vector<Position> positions;
  while (next_) {
    if (request_.check) {
      if (auto going = request_.check(); !going) return going.error();
    }
    slots.clear();
    positions.clear();
    for (; next_ && slots.size() < kChunk; next_ = terrain_.ids().first_from(VertexId(next_->value() + 1))) {
      slots.push_back(*terrain_.slot_of(*next_));
      positions.push_back(own(slots.back()));
    }
    convert(positions);
    for (std::size_t i = 0; i < slots.size(); ++i) {
      std::uint32_t& number = number_[slots[i].value()];
      if (number == kAbsent && !(request_.box && inside(positions[i], *request_.box))) continue;
      if (ok_[i] == 0) {
        return error(Code::kInvalidValue, "Some vertices have no position in that CRS.", "query:crs");
      }
      number = count++;
      const Position& at = positions[i];
      head_.low = {std::min(head_.low.x, at.x), std::min(head_.low.y, at.y), std::min(head_.low.z, at.z)};
      head_.high = {std::max(head_.high.x, at.x), std::max(head_.high.y, at.y), std::max(head_.high.z, at.z)};
    }
  }
  head_.vertices = count;
  if (count > 0) return {};
  if (terrain_.vertex_count() == 0) return error(Code::kInvalidValue, "The TIN is empty.");
  return error(Code::kInvalidValue, "The box holds nothing of the TIN.", "query:bbox");
}

Position TerrainMesh::own(VertexSlot slot) const {
  const auto at = terrain_.mesh().point(slot);
  return {terrain_.frame().x.world(at.x), terrain_.frame().y.world(at.y), terrain_.z(slot)};
}

/// In place; sets ok_. Positions without a counterpart become infinite, and so touch no box.
bool TerrainMesh::convert(std::vector<Position>& positions) {
  ok_.assign(positions.size(), 1);
  if (!request_.convert) return true;
  x_.clear();
  y_.clear();
  for (const Position& at : positions) {
    x_.push_back(at.x);
    y_.push_back(at.y);
  }
  const bool all = request_.convert(x_, y_, ok_);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    positions[i].x = x_[i];
    positions[i].y = y_[i];
  }
  return all;
}

void TerrainMesh::rewind() {
  next_ = terrain_.ids().first_from(VertexId(0));
  chunk_.clear();
  at_ = 0;
  walk_.emplace(terrain_, tin::query::TriangleCursor{});
  walked_ = 0;
}

bool TerrainMesh::refill() {
  chunk_.clear();
  at_ = 0;
  std::vector<Position> positions;
  for (; next_ && chunk_.size() < kChunk; next_ = terrain_.ids().first_from(VertexId(next_->value() + 1))) {
    const VertexSlot slot = *terrain_.slot_of(*next_);
    if (number_[slot.value()] == kAbsent) continue;
    chunk_.push_back({*next_, {}});
    positions.push_back(own(slot));
  }
  convert(positions);
  for (std::size_t i = 0; i < chunk_.size(); ++i) chunk_[i].at = positions[i];
  return !chunk_.empty();
}

bool TerrainMesh::next_vertex(MeshVertex& vertex) {
  if (at_ == chunk_.size() && !refill()) return false;
  vertex = chunk_[at_++];
  return true;
}

bool TerrainMesh::next_triangle(MeshTriangle& triangle) {
  for (;;) {
    const auto found = walk_->next();
    if (!found) return false;
    const std::size_t which = walked_++;
    if (!is_kept(which)) continue;
    for (std::size_t i = 0; i < 3; ++i) triangle.corners[i] = number_[found->slots[i].value()];
    triangle.hidden = is_hidden(which);
    return true;
  }
}

}  // namespace proto::formats
