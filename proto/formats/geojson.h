// Vertices and triangles of a TIN as RFC 7946 GeoJSON, written piece by piece.
//
//   std::string out;
//   GeoJsonWriter writer(out, Coordinates::kDegrees);
//   writer.begin({});
//   for (...) { writer.vertex(id, position); if (out.size() > kChunk) { send(out); out.clear(); } }
//   writer.end();
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "proto/messages.h"

namespace proto::formats {

inline constexpr std::string_view kGeoJsonMediaType = "application/geo+json";

/// How x and y are rounded: degrees to 9 decimals (0.1 mm), projected units to 4, or not at all. z is written
/// in full.
enum class Coordinates { kDegrees, kProjected, kExact };

/// What stands before the features. Everything may be missing.
struct CollectionHead {
  std::optional<std::uint64_t> number_matched;
  std::optional<std::uint64_t> number_returned;
  std::vector<Link> links;
  /// For coordinates other than CRS84: written as the pre-RFC "crs" member, which GDAL and QGIS understand.
  std::optional<std::string> crs_urn;
  /// As frame_note() gives it: a member that others pass over.
  std::optional<std::string> frame_note;
};

/// Appends to a string that the caller may empty between any two calls.
class GeoJsonWriter {
 public:
  /// `continued`: features were written already, by another writer.
  GeoJsonWriter(std::string& out, Coordinates coordinates, bool continued = false);

  void begin(const CollectionHead& head);
  /// A Point with the vertex's id as its id. Requires: finite coordinates.
  void vertex(VertexId id, const Position& at);
  /// A Polygon of four positions whose id is "a-b-c". Requires: counter-clockwise, ids[i] stands at
  /// corners[i]. Ensures: the same bytes whichever corner comes first: the smallest id begins.
  void triangle(const std::array<VertexId, 3>& ids, const std::array<Position, 3>& corners);
  /// A LineString of two positions whose id is "a-b". `hull`: nothing lies on one of its sides.
  void edge(const std::array<VertexId, 2>& ids, const std::array<Position, 2>& ends, bool hull);
  /// A LineString of `z` with the properties "elevation" and "closed". Requires: two positions or more, finite.
  void contour(double z, bool closed, std::span<const Position2> at);
  /// A Point with the property "elevation", which is null where there is none.
  void sample(Position2 at, std::optional<double> z);
  /// A stretch of surface along a line: a LineString (a Point when it is one position) with arrays as the properties
  /// "elevation" and "distance", each left out when empty. Requires: as many of each as positions, `z` finite.
  void stretch(std::span<const Position2> at, std::span<const double> z, std::span<const double> elevation,
               std::span<const double> distance);
  void end();

 private:
  void separate();
  void append_position(const Position& at);
  void append_place(Position2 at);

  std::string& out_;
  Coordinates coordinates_;
  bool first_;
};

/// The id that triangle() writes.
std::string triangle_id(const std::array<VertexId, 3>& ids);

/// A feature as the writer appended it, with links.
std::string feature_with_links(std::string_view feature, std::span<const Link> links);

}  // namespace proto::formats
