#include "server/api/feature_reader.h"

#include <algorithm>

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

bool inside(const Position& p, const Bbox& box) {
  const bool level = !box.min_z || (p.z >= *box.min_z && p.z <= *box.max_z);
  return level && p.x >= box.min_x && p.x <= box.max_x && p.y >= box.min_y && p.y <= box.max_y;
}

/// Whether the box lies wholly beyond the edge from `a` to `b` of a counter-clockwise triangle.
bool beyond(const Position& a, const Position& b, const Bbox& box) {
  const double normal_x = b.y - a.y, normal_y = a.x - b.x;  // points outwards
  const double nearest_x = normal_x > 0 ? box.min_x : box.max_x,
               nearest_y = normal_y > 0 ? box.min_y : box.max_y;
  return normal_x * (nearest_x - a.x) + normal_y * (nearest_y - a.y) > 0;
}

}  // namespace

std::optional<FeatureKind> feature_kind(std::string_view name) {
  if (name == "vertices") return FeatureKind::kVertices;
  if (name == "triangles") return FeatureKind::kTriangles;
  return std::nullopt;
}

bool touches(const std::array<Position, 3>& c, const Bbox& box) {
  const auto [min_x, max_x] = std::minmax({c[0].x, c[1].x, c[2].x});
  const auto [min_y, max_y] = std::minmax({c[0].y, c[1].y, c[2].y});
  const auto [min_z, max_z] = std::minmax({c[0].z, c[1].z, c[2].z});
  if (min_x > box.max_x || max_x < box.min_x || min_y > box.max_y || max_y < box.min_y) return false;
  if (box.min_z && (min_z > *box.max_z || max_z < *box.min_z)) return false;
  return !beyond(c[0], c[1], box) && !beyond(c[1], c[2], box) && !beyond(c[2], c[0], box);
}

void write_feature(proto::formats::GeoJsonWriter& writer, FeatureKind kind, const Feature& feature) {
  if (kind == FeatureKind::kVertices) {
    writer.vertex(feature.ids[0], feature.corners[0]);
  } else {
    writer.triangle(feature.ids, feature.corners);
  }
}

FeatureReader::FeatureReader(const tin::terrain::Terrain& terrain, FeatureKind kind, FeatureCursor from,
                             Positions positions, std::optional<Bbox> box)
    : terrain_(terrain), kind_(kind), positions_(std::move(positions)), box_(box) {
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
    return corners == 1 ? !inside(feature.corners[0], *box_) : !touches(feature.corners, *box_);
  });
}

}  // namespace server::api
