#include "server/api/feature_reader.h"

#include <algorithm>

#include "tin/query/void_triangles.h"

namespace server::api {

using proto::Bbox;
using proto::Position;
using proto::VertexId;

namespace {

constexpr std::size_t kChunk = 1024;

Position world(const tin::terrain::Terrain& terrain, tin::mesh::VertexSlot slot) {
  const auto at = terrain.mesh().point(slot);
  return {terrain.frame().x.world(at.x), terrain.frame().y.world(at.y), terrain.z(slot)};
}

}  // namespace

std::optional<FeatureKind> feature_kind(std::string_view name) {
  if (name == "vertices") return FeatureKind::kVertices;
  if (name == "triangles") return FeatureKind::kTriangles;
  return std::nullopt;
}

void write_feature(proto::formats::GeoJsonWriter& writer, FeatureKind kind, const Feature& feature) {
  if (kind == FeatureKind::kVertices) {
    writer.vertex(feature.ids[0], feature.corners[0]);
  } else {
    writer.triangle(feature.ids, feature.corners);
  }
}

FeatureReader::FeatureReader(const tin::terrain::Terrain& terrain, FeatureKind kind, FeatureCursor from,
                             Positions positions, std::optional<Bbox> box, tin::query::Voids voids)
    : terrain_(terrain),
      kind_(kind),
      positions_(std::move(positions)),
      box_(box),
      hide_voids_(voids == tin::query::Voids::kKeep && tin::query::has_voids(terrain)) {
  if (kind == FeatureKind::kVertices) {
    next_vertex_ = terrain.ids().first_from(VertexId(from.vertex));
  } else {
    walk_.emplace(terrain, from);
  }
}

std::optional<Feature> FeatureReader::next() {
  while (at_ == chunk_.size() && !exhausted_) refill();
  if (at_ == chunk_.size()) return std::nullopt;
  return chunk_[at_++];
}

void FeatureReader::refill() {
  chunk_.clear();
  at_ = 0;
  if (kind_ == FeatureKind::kVertices) {
    collect_vertices();
  } else {
    collect_triangles();
  }
  convert();
}

void FeatureReader::collect_vertices() {
  while (next_vertex_ && chunk_.size() < kChunk) {
    const VertexId id = *next_vertex_;
    Feature feature{{id.value(), 0}, {id}, {}};
    feature.corners[0] = world(terrain_, *terrain_.slot_of(id));
    chunk_.push_back(feature);
    next_vertex_ = terrain_.ids().first_from(VertexId(id.value() + 1));
  }
  exhausted_ = !next_vertex_;
}

void FeatureReader::collect_triangles() {
  while (chunk_.size() < kChunk) {
    Feature feature;
    feature.at = walk_->cursor();
    const auto triangle = walk_->next();
    if (!triangle) {
      exhausted_ = true;
      return;
    }
    if (hide_voids_ && tin::query::over_void(terrain_, triangle->slots)) continue;
    feature.ids = triangle->ids;
    for (std::size_t i = 0; i < 3; ++i) feature.corners[i] = world(terrain_, triangle->slots[i]);
    chunk_.push_back(feature);
  }
}

/// Converts the chunk's positions and drops what lies outside the box.
void FeatureReader::convert() {
  const std::size_t corners = kind_ == FeatureKind::kVertices ? 1 : 3;
  if (!positions_.identity()) {
    x_.clear();
    y_.clear();
    for (const Feature& feature : chunk_) {
      for (std::size_t i = 0; i < corners; ++i) {
        x_.push_back(feature.corners[i].x);
        y_.push_back(feature.corners[i].y);
      }
    }
    positions_.convert(x_, y_, ok_);
    for (std::size_t f = 0, j = 0; f < chunk_.size(); ++f) {
      for (std::size_t i = 0; i < corners; ++i, ++j) {
        chunk_[f].corners[i].x = x_[j];
        chunk_[f].corners[i].y = y_[j];
      }
    }
  } else {
    ok_.assign(chunk_.size() * corners, 1);
  }
  std::size_t read = 0;
  std::erase_if(chunk_, [&](const Feature& feature) {
    const auto* ok = &ok_[corners * read++];
    if (std::any_of(ok, ok + corners, [](std::uint8_t fine) { return fine == 0; })) return true;
    if (!box_) return false;
    return corners == 1 ? !proto::inside(feature.corners[0], *box_) : !proto::touches(feature.corners, *box_);
  });
}

}  // namespace server::api
