// Positions between the wire and a TIN's own CRS.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "proto/messages.h"
#include "server/gdal/crs.h"
#include "tin/base/result.h"
#include "tin/frame/frame.h"

namespace server::api {

/// Converts x and y arrays from one CRS to another; equal CRSs cost nothing. One thread.
class Positions {
 public:
  /// From `from` to `to`, both as gdal::read_crs() takes them. An empty name is a local CRS, which goes with
  /// itself only. Errors: kInvalidValue (one is local or unknown, or there is no way between them), at
  /// `where`.
  static tin::base::Result<Positions> between(std::string_view from, std::string_view to, std::string where);
  /// From the TIN to GeoJSON's CRS84; a local CRS stays as it is.
  static tin::base::Result<Positions> to_geojson(const tin::frame::Frame& frame);
  static tin::base::Result<Positions> from_geojson(const tin::frame::Frame& frame);

  bool identity() const { return !transform_; }
  /// In place; ok[i] is 0 where a position has no counterpart. Returns whether all have.
  bool convert(std::span<double> x, std::span<double> y, std::vector<std::uint8_t>& ok);
  /// One position; nothing where it has no counterpart.
  std::optional<proto::Position2> convert(proto::Position2 position);

 private:
  std::unique_ptr<gdal::CrsTransform> transform_;
};

/// Whether GeoJSON of this frame is in degrees.
bool geojson_in_degrees(const tin::frame::Frame& frame);

}  // namespace server::api
