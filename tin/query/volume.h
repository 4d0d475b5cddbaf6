// Volumes and areas: of a terrain against a level, and between two terrains. Clipped and integrated piece by
// piece, without sampling.
#pragma once

#include "tin/base/progress.h"
#include "tin/base/result.h"
#include "tin/frame/ground.h"
#include "tin/query/region.h"
#include "tin/query/voids.h"
#include "tin/terrain/terrain.h"

namespace tin::query {

/// What of a terrain is asked about.
struct Where {
  const Region* region = nullptr;  // on the terrain's lattice; null: everywhere
  Voids voids = Voids::kKeep;
};

/// Square and cubic metres. Ground at the level counts as above.
struct LevelVolumes {
  double area_above = 0, area_below = 0;  // in the plan
  double volume_above = 0;                // between the level and higher ground
  double volume_below = 0;                // between lower ground and the level
};

/// The surface against a level, in the vertical unit. Equal for every history of the same set. Zero where
/// there is no surface. Errors: kCancelled. Cost: O(triangles) (with a region: those it meets, once per
/// triangle of the region), and the cells of voids.
base::Result<LevelVolumes> volumes_at(const terrain::Terrain& terrain, const frame::Ground& ground,
                                      double level, const Where& where, base::Progress* progress = nullptr);

/// Square metres.
struct SurfaceArea {
  double planar = 0;   // in the plan
  double surface = 0;  // along the slopes
};
/// As volumes_at().
base::Result<SurfaceArea> surface_area(const terrain::Terrain& terrain, const frame::Ground& ground,
                                       const Where& where, base::Progress* progress = nullptr);

/// What it takes to turn one surface into another, in square and cubic metres.
struct CutFill {
  double cut_area = 0, fill_area = 0,
         equal_area = 0;   // in the plan; together the area that both surfaces cover
  double cut_volume = 0;   // where `after` lies below `before`
  double fill_volume = 0;  // where it lies above
};

/// Exact on the overlay of both triangulations: each pair of triangles that overlap is intersected.
/// Differences below 1e-12 of the elevations count as equal. `where` is about `before`; voids are those of
/// either. The terrains may have frames of their own in one CRS; elevations are compared in metres. Equal for
/// every history of the same sets. Errors: kInvalidValue (different CRSs), kCancelled. Cost: O(pairs that
/// overlap).
base::Result<CutFill> cut_fill(const terrain::Terrain& before, const terrain::Terrain& after,
                               const frame::Ground& ground, const Where& where,
                               base::Progress* progress = nullptr);

}  // namespace tin::query
