// The coordinates of an exported file, and what the file has to say of them: the terrain's own, or those of a CRS that
// is asked for.
#pragma once

#include <string>

#include "proto/formats/geojson.h"
#include "proto/formats/terrain_mesh.h"
#include "server/api/positions.h"

namespace server::api {

/// A request for all of a mesh with coordinates of `crs` (any form that gdal::read_crs() takes; empty: the frame's). Title,
/// box and the rest are the caller's. Errors: kInvalidValue at "query:crs".
tin::base::Result<proto::formats::MeshRequest> mesh_request(const tin::frame::Frame& frame,
                                                            const std::string& crs = {});

/// How features stand in a GeoJSON file.
struct GeoJsonCoordinates {
  Positions positions;
  proto::formats::Coordinates rounding;
  proto::formats::CollectionHead head;
};

/// In `crs`; empty: CRS84, or the frame's own coordinates where it has no CRS. What is not converted is not rounded, and the
/// head notes the lattice. Errors: kInvalidValue at "query:crs".
tin::base::Result<GeoJsonCoordinates> geojson_coordinates(const tin::frame::Frame& frame, const std::string& crs = {});

}  // namespace server::api
