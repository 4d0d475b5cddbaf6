#include "server/api/feature_reader.h"

#include <algorithm>
#include <charconv>

#include "server/api/export_grid.h"
#include "tin/query/void_triangles.h"

namespace server::api {

using proto::Bbox;
using proto::Position;
using proto::VertexId;
using tin::frame::Extent;
using tin::terrain::Terrain;

namespace {

constexpr std::size_t kChunk = 1024;

Position world(const Terrain& terrain, tin::mesh::VertexSlot slot) {
  const auto at = terrain.mesh().point(slot);
  return {terrain.frame().x.world(at.x), terrain.frame().y.world(at.y), terrain.z(slot)};
}

/// Whether the straight line between two positions and the box have a point in common.
bool line_touches(const Position& a, const Position& b, const Bbox& box) {
  const std::array<Position, 3> there_and_back{a, b, a};  // its two sides bound the line from either side
  return proto::touches(there_and_back, box);
}

bool over_void(const Terrain& terrain, const tin::query::TriangleView& triangle) {
  return tin::query::over_void(terrain, triangle.slots);
}
bool over_void(const Terrain&, const tin::query::EdgeView&) {
  return false;
}

/// An extent in the terrain's CRS that holds what lies in the boxes, with room to spare for the bending of straight lines;
/// nothing where that cannot be said. `whole` is the terrain's extent in the boxes' CRS.
std::optional<Extent> extent_near(const std::vector<Bbox>& boxes, const Extent& whole, Positions& from_box) {
  constexpr int kParts = 16;
  constexpr double kRoom = 0.05;
  std::vector<double> x, y;
  const double room_x = kRoom * (whole.max_x - whole.min_x) + 1e-6, room_y = kRoom * (whole.max_y - whole.min_y) + 1e-6;
  for (const Bbox& box : boxes) {
    const double x0 = std::max(box.min_x, whole.min_x - room_x), x1 = std::min(box.max_x, whole.max_x + room_x);
    const double y0 = std::max(box.min_y, whole.min_y - room_y), y1 = std::min(box.max_y, whole.max_y + room_y);
    if (x0 > x1 || y0 > y1) continue;
    for (int i = 0; i <= kParts; ++i) {
      for (int j = 0; j <= kParts; ++j) {
        x.push_back(x0 + (x1 - x0) * i / kParts);
        y.push_back(y0 + (y1 - y0) * j / kParts);
      }
    }
  }
  if (x.empty()) return Extent{0, 0, -1, -1};  // no box is near: nothing touches this
  std::vector<std::uint8_t> ok;
  if (!from_box.convert(x, y, ok)) return std::nullopt;
  const auto [min_x, max_x] = std::minmax_element(x.begin(), x.end());
  const auto [min_y, max_y] = std::minmax_element(y.begin(), y.end());
  const double more_x = kRoom * (*max_x - *min_x) + 1e-9 * std::abs(*max_x),
               more_y = kRoom * (*max_y - *min_y) + 1e-9 * std::abs(*max_y);
  return Extent{*min_x - more_x, *min_y - more_y, *max_x + more_x, *max_y + more_y};
}

template <std::size_t n>
std::optional<std::array<VertexId, n>> parse_ids(std::string_view text) {
  std::array<VertexId, n> ids;
  for (std::size_t i = 0; i < n; ++i) {
    std::uint64_t value = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
    if (read.ec != std::errc{} || value == 0 || text.front() == '0') return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(read.ptr - text.data()));
    ids[i] = VertexId(value);
    if (i + 1 < n) {
      if (!text.starts_with('-')) return std::nullopt;
      text.remove_prefix(1);
    }
  }
  return text.empty() ? std::optional(ids) : std::nullopt;
}

Feature feature_of(const Terrain& terrain, const tin::query::TriangleView& triangle) {
  Feature feature;
  feature.ids = triangle.ids;
  for (std::size_t i = 0; i < 3; ++i) feature.corners[i] = world(terrain, triangle.slots[i]);
  return feature;
}

Feature feature_of(const Terrain& terrain, const tin::query::EdgeView& edge) {
  Feature feature;
  feature.ids = {edge.ids[0], edge.ids[1]};
  feature.corners = {world(terrain, edge.slots[0]), world(terrain, edge.slots[1])};
  feature.hull = edge.hull;
  return feature;
}

std::optional<Feature> find_triangle(const Terrain& terrain, const std::array<VertexId, 3>& ids) {
  std::vector<tin::query::TriangleView> at_first;
  tin::query::triangles_of(terrain, ids[0], at_first);
  for (const auto& triangle : at_first) {
    if (triangle.ids == ids) return feature_of(terrain, triangle);
  }
  return std::nullopt;
}

}  // namespace

std::optional<FeatureKind> feature_kind(std::string_view name) {
  if (name == "vertices") return FeatureKind::kVertices;
  if (name == "triangles") return FeatureKind::kTriangles;
  if (name == "edges") return FeatureKind::kEdges;
  return std::nullopt;
}

std::string_view collection_name(FeatureKind kind) {
  switch (kind) {
    case FeatureKind::kVertices:
      return "vertices";
    case FeatureKind::kTriangles:
      return "triangles";
    case FeatureKind::kEdges:
      break;
  }
  return "edges";
}

std::size_t corner_count(FeatureKind kind) {
  if (kind == FeatureKind::kVertices) return 1;
  return kind == FeatureKind::kTriangles ? 3 : 2;
}

std::size_t feature_count(const Terrain& terrain, FeatureKind kind) {
  if (kind == FeatureKind::kVertices) return terrain.vertex_count();
  return kind == FeatureKind::kTriangles ? terrain.triangle_count() : tin::query::edge_count(terrain);
}

Feature vertex_feature(const tin::terrain::Vertex& vertex, const tin::frame::Frame& frame) {
  Feature feature;
  feature.ids[0] = vertex.id;
  feature.corners[0] = {frame.x.world(vertex.at.x), frame.y.world(vertex.at.y), vertex.z};
  return feature;
}

std::optional<Feature> find_feature(const Terrain& terrain, FeatureKind kind, std::string_view id) {
  if (kind == FeatureKind::kVertices) {
    const auto ids = parse_ids<1>(id);
    const auto vertex = ids ? terrain.vertex((*ids)[0]) : std::nullopt;
    if (!vertex) return std::nullopt;
    return vertex_feature(*vertex, terrain.frame());
  }
  if (kind == FeatureKind::kTriangles) {
    const auto ids = parse_ids<3>(id);
    return ids ? find_triangle(terrain, *ids) : std::nullopt;
  }
  const auto ids = parse_ids<2>(id);
  if (!ids) return std::nullopt;
  std::vector<tin::query::EdgeView> at_first;
  tin::query::edges_of(terrain, (*ids)[0], at_first);
  for (const auto& edge : at_first) {
    if (edge.ids == *ids) return feature_of(terrain, edge);
  }
  return std::nullopt;
}

void write_feature(proto::formats::GeoJsonWriter& writer, FeatureKind kind, const Feature& feature) {
  if (kind == FeatureKind::kVertices) {
    writer.vertex(feature.ids[0], feature.corners[0]);
  } else if (kind == FeatureKind::kTriangles) {
    writer.triangle(feature.ids, feature.corners);
  } else {
    writer.edge({feature.ids[0], feature.ids[1]}, {feature.corners[0], feature.corners[1]}, feature.hull);
  }
}

FeatureReader::FeatureReader(const Terrain& terrain, FeatureKind kind, FeatureCursor from, Positions positions,
                             std::optional<Bbox> box, tin::query::Voids voids)
    : terrain_(terrain),
      kind_(kind),
      corners_(corner_count(kind)),
      positions_(std::move(positions)),
      box_(box),
      hide_voids_(voids == tin::query::Voids::kKeep && tin::query::has_voids(terrain)) {
  if (kind == FeatureKind::kVertices) {
    next_vertex_ = terrain.ids().first_from(VertexId(from.vertex));
  } else if (kind == FeatureKind::kTriangles) {
    triangles_.emplace(terrain, from);
  } else {
    edges_.emplace(terrain, from);
  }
}

void FeatureReader::within(std::vector<Bbox> boxes, Positions to_box, Positions from_box) {
  boxes_ = std::move(boxes);
  if (const auto whole = extent_in(terrain_, to_box)) near_ = extent_near(boxes_, *whole, from_box);
  to_box_ = std::move(to_box);
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
  } else if (kind_ == FeatureKind::kTriangles) {
    collect_from(*triangles_);
  } else {
    collect_from(*edges_);
  }
  if (to_box_) keep_those_in_boxes();
  to_output();
}

/// Appends the feature unless it is far from the boxes.
void FeatureReader::take(Feature feature) {
  if (near_) {
    const auto first = feature.corners.begin(), last = first + static_cast<std::ptrdiff_t>(corners_);
    const auto [min_x, max_x] = std::minmax_element(first, last, [](auto& a, auto& b) { return a.x < b.x; });
    const auto [min_y, max_y] = std::minmax_element(first, last, [](auto& a, auto& b) { return a.y < b.y; });
    if (min_x->x > near_->max_x || max_x->x < near_->min_x || min_y->y > near_->max_y || max_y->y < near_->min_y) return;
  }
  chunk_.push_back(feature);
}

void FeatureReader::collect_vertices() {
  while (next_vertex_ && chunk_.size() < kChunk) {
    const VertexId id = *next_vertex_;
    Feature feature{{id.value(), 0}, {id}, {}};
    feature.corners[0] = world(terrain_, *terrain_.slot_of(id));
    take(feature);
    next_vertex_ = terrain_.ids().first_from(VertexId(id.value() + 1));
  }
  exhausted_ = !next_vertex_;
}

template <class Walk>
void FeatureReader::collect_from(Walk& walk) {
  while (chunk_.size() < kChunk) {
    const FeatureCursor at = walk.cursor();
    const auto found = walk.next();
    if (!found) {
      exhausted_ = true;
      return;
    }
    if (hide_voids_ && over_void(terrain_, *found)) continue;
    Feature feature = feature_of(terrain_, *found);
    feature.at = at;
    take(feature);
  }
}

/// The chunk's corners in another CRS; ok_ has one entry a corner.
void FeatureReader::convert(Positions& positions, std::vector<std::array<Position, 3>>& corners) {
  corners.clear();
  for (const Feature& feature : chunk_) corners.push_back(feature.corners);
  if (positions.identity()) {
    ok_.assign(chunk_.size() * corners_, 1);
    return;
  }
  x_.clear();
  y_.clear();
  for (const auto& of_feature : corners) {
    for (std::size_t i = 0; i < corners_; ++i) {
      x_.push_back(of_feature[i].x);
      y_.push_back(of_feature[i].y);
    }
  }
  positions.convert(x_, y_, ok_);
  std::size_t j = 0;
  for (auto& of_feature : corners) {
    for (std::size_t i = 0; i < corners_; ++i, ++j) {
      of_feature[i].x = x_[j];
      of_feature[i].y = y_[j];
    }
  }
}

/// Whether a feature with these corners and the box have a point in common.
bool FeatureReader::meets(const std::array<Position, 3>& corners, const Bbox& box) const {
  if (kind_ == FeatureKind::kVertices) return proto::inside(corners[0], box);
  return kind_ == FeatureKind::kTriangles ? proto::touches(corners, box) : line_touches(corners[0], corners[1], box);
}

void FeatureReader::keep_those_in_boxes() {
  convert(*to_box_, converted_);
  std::size_t read = 0;
  std::erase_if(chunk_, [&](const Feature&) {
    const std::size_t i = read++;
    const auto* ok = &ok_[corners_ * i];
    if (std::any_of(ok, ok + corners_, [](std::uint8_t fine) { return fine == 0; })) return true;
    return std::none_of(boxes_.begin(), boxes_.end(), [&](const Bbox& box) { return meets(converted_[i], box); });
  });
}

/// Converts the chunk's positions and drops what cannot be converted or lies outside the box of the output.
void FeatureReader::to_output() {
  convert(positions_, converted_);
  std::size_t read = 0;
  for (std::size_t i = 0; i < chunk_.size(); ++i) chunk_[i].corners = converted_[i];
  std::erase_if(chunk_, [&](const Feature& feature) {
    const auto* ok = &ok_[corners_ * read++];
    if (std::any_of(ok, ok + corners_, [](std::uint8_t fine) { return fine == 0; })) return true;
    if (!box_) return false;
    return !meets(feature.corners, *box_);
  });
}

}  // namespace server::api
