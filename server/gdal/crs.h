// Coordinate reference systems: what a client or a file names, and conversion between two of them.
//
//   auto crs = read_crs("http://www.opengis.net/def/crs/EPSG/0/32617");  // crs->name == "EPSG:32617"
//   auto way = CrsTransform::create("EPSG:4326", "EPSG:32617");          // lon, lat -> easting, northing
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "tin/base/result.h"
#include "tin/frame/frame.h"

namespace server::gdal {

/// A unit of heights: "metre", "foot", "US survey foot" or as its source calls it.
struct VerticalUnit {
  std::string name;
  double metres = 1;
};

struct CrsInfo {
  /// "EPSG:n" where that says it all, else WKT2 on one line. OGC CRS84 is named EPSG:4326: positions are in
  /// GIS order (easting or longitude first) everywhere in this server.
  std::string name;
  tin::frame::GroundScale scale;
  std::optional<VerticalUnit> vertical;  // of a compound or three-dimensional CRS
  /// Whether its authority puts latitude or northing first: the order of coordinates where a standard says so.
  bool northing_first = false;
};

/// Reads "EPSG:n", the OGC URI or URN of an EPSG code, any of the names of CRS84, or WKT. Needs no file and
/// no network, whatever the text is. Errors: kMalformed when it is none of these; kUnsupported for an unknown
/// code and for a CRS that has no easting and northing or longitude and latitude in degrees.
tin::base::Result<CrsInfo> read_crs(std::string_view text);

/// A unit of heights by one of its many names ("m", "ft", "us-ft" ...); nothing for an unknown one.
std::optional<VerticalUnit> vertical_unit(std::string_view name);

/// Converts positions from one CRS to another. Not to be used by two threads at once.
class CrsTransform {
 public:
  /// Errors: as read_crs(); kUnsupported when there is no way from one to the other.
  static tin::base::Result<CrsTransform> create(std::string_view from, std::string_view to);

  CrsTransform(CrsTransform&&) noexcept;
  CrsTransform& operator=(CrsTransform&&) noexcept;
  ~CrsTransform();

  /// Converts in place; `ok[i]` tells whether position i could be converted, those that could not become
  /// infinite. Returns whether all could. Requires: spans of equal length.
  bool transform(std::span<double> x, std::span<double> y, std::span<std::uint8_t> ok);

 private:
  struct Impl;
  explicit CrsTransform(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace server::gdal
