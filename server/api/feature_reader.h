// The vertices or triangles of a terrain as GeoJSON features, in their fixed order, within a box.
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

enum class FeatureKind { kVertices, kTriangles };

/// "vertices" or "triangles".
std::optional<FeatureKind> feature_kind(std::string_view name);

/// Where a walk over features stands; for vertices `done` is 0.
using FeatureCursor = tin::query::TriangleCursor;

struct Feature {
  FeatureCursor at;  // a walk from here begins with this feature
  std::array<proto::VertexId, 3> ids{};
  std::array<proto::Position, 3> corners{};  // of a vertex the first only
};

/// Reads in chunks, so that conversion of coordinates is fast. Borrows the terrain. One thread.
class FeatureReader {
 public:
  /// `box` is in the coordinates that `positions` converts to. Features whose positions have no counterpart
  /// there are left out; with kKeep also triangles over voids (tin/query/void_triangles.h).
  FeatureReader(const tin::terrain::Terrain& terrain, FeatureKind kind, FeatureCursor from,
                Positions positions, std::optional<proto::Bbox> box,
                tin::query::Voids voids = tin::query::Voids::kFill);

  /// The next feature inside or touching the box; nothing after the last.
  std::optional<Feature> next();

 private:
  void refill();
  void collect_vertices();
  void collect_triangles();
  void convert();

  const tin::terrain::Terrain& terrain_;
  const FeatureKind kind_;
  Positions positions_;
  const std::optional<proto::Bbox> box_;
  const bool hide_voids_;
  std::optional<proto::VertexId> next_vertex_;
  std::optional<tin::query::TriangleWalk> walk_;
  bool exhausted_ = false;
  std::vector<Feature> chunk_;
  std::size_t at_ = 0;
  std::vector<double> x_, y_;
  std::vector<std::uint8_t> ok_;
};

void write_feature(proto::formats::GeoJsonWriter& writer, FeatureKind kind, const Feature& feature);

}  // namespace server::api
