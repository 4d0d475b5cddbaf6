// The vertices, triangles or edges of a terrain as GeoJSON features, in their fixed order, within boxes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/bbox.h"
#include "proto/formats/geojson.h"
#include "proto/messages.h"
#include "server/api/positions.h"
#include "tin/query/elevation.h"
#include "tin/query/order.h"
#include "tin/terrain/terrain.h"

namespace server::api {

enum class FeatureKind { kVertices, kTriangles, kEdges };

/// "vertices", "triangles" or "edges".
std::optional<FeatureKind> feature_kind(std::string_view name);
std::string_view collection_name(FeatureKind kind);
/// How many positions a feature has: 1, 3 or 2.
std::size_t corner_count(FeatureKind kind);
/// How many features a terrain has of a kind. O(1).
std::size_t feature_count(const tin::terrain::Terrain& terrain, FeatureKind kind);

/// Where a walk over features stands; for vertices `done` is 0.
using FeatureCursor = tin::query::TriangleCursor;

struct Feature {
  FeatureCursor at;  // a walk from here begins with this feature
  std::array<proto::VertexId, 3> ids{};
  std::array<proto::Position, 3> corners{};  // as many as corner_count()
  bool hull = false;                         // an edge with nothing on one side
};

/// Reads in chunks, so that conversion of coordinates is fast. Borrows the terrain. One thread.
class FeatureReader {
 public:
  /// `box` is in the coordinates that `positions` converts to. Features whose positions have no counterpart
  /// there are left out; with kKeep also triangles over voids (tin/query/void_triangles.h).
  FeatureReader(const tin::terrain::Terrain& terrain, FeatureKind kind, FeatureCursor from,
                Positions positions, std::optional<proto::Bbox> box,
                tin::query::Voids voids = tin::query::Voids::kFill);

  /// Only features that touch one of these boxes, which may be in a CRS of their own: `to_box` converts into it, `from_box`
  /// out of it. To be called before the first next().
  void within(std::vector<proto::Bbox> boxes, Positions to_box, Positions from_box);

  /// The next feature inside or touching the box; nothing after the last.
  std::optional<Feature> next();

 private:
  void refill();
  void collect_vertices();
  template <class Walk>
  void collect_from(Walk& walk);
  void take(Feature feature);
  void convert(Positions& positions, std::vector<std::array<proto::Position, 3>>& corners);
  bool meets(const std::array<proto::Position, 3>& corners, const proto::Bbox& box) const;
  void keep_those_in_boxes();
  void to_output();

  const tin::terrain::Terrain& terrain_;
  const FeatureKind kind_;
  const std::size_t corners_;
  Positions positions_;
  const std::optional<proto::Bbox> box_;
  const bool hide_voids_;
  std::vector<proto::Bbox> boxes_;
  std::optional<Positions> to_box_;
  std::optional<tin::frame::Extent> near_;  // in the terrain's CRS: what touches the boxes touches this
  std::optional<proto::VertexId> next_vertex_;
  std::optional<tin::query::TriangleWalk> triangles_;
  std::optional<tin::query::EdgeWalk> edges_;
  bool exhausted_ = false;
  std::vector<Feature> chunk_;
  std::vector<std::array<proto::Position, 3>> converted_;
  std::size_t at_ = 0;
  std::vector<double> x_, y_;
  std::vector<std::uint8_t> ok_;
};

/// A vertex as a feature, in the terrain's CRS.
Feature vertex_feature(const tin::terrain::Vertex& vertex, const tin::frame::Frame& frame);

/// The feature of a kind that an id names ("7", "1-2-3", "1-2"), in the terrain's CRS; nothing when there is none.
std::optional<Feature> find_feature(const tin::terrain::Terrain& terrain, FeatureKind kind, std::string_view id);

void write_feature(proto::formats::GeoJsonWriter& writer, FeatureKind kind, const Feature& feature);

}  // namespace server::api
