// Edits as clients mean them, in the TIN's CRS, and what the frame makes of them.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "tin/base/result.h"
#include "tin/frame/frame.h"
#include "tin/query/region.h"
#include "tin/terrain/edit.h"
#include "tin/terrain/terrain.h"

namespace server::app {

using VertexId = tin::terrain::VertexId;

/// Edits with positions in the TIN's CRS. The frame turns them into lattice points.
struct InsertAt {
  double x = 0, y = 0, z = 0;
};
struct MoveTo {
  VertexId id;
  double x = 0, y = 0;
};
/// Removes all vertices that stand in a polygon or on it when its turn comes.
struct RemoveWithin {
  std::vector<std::array<double, 2>> polygon;
};
using WorldEdit = std::variant<InsertAt, tin::terrain::Remove, MoveTo, tin::terrain::SetZ, RemoveWithin>;

/// The same on the lattice.
struct LatticeEdits {
  struct Area {
    std::size_t index;  // among all edits
    tin::query::Ring ring;
  };
  std::vector<tin::terrain::Edit> edits;  // those that concern one vertex
  std::vector<Area> areas;                // ascending
};

/// An edit of an area, by its index, and how many vertices it removed.
using AreaResult = std::pair<std::size_t, std::size_t>;

/// Applies all edits or none; `areas` gets one entry for each of an area. As many ids as edits, but for
/// these. Errors: as Terrain::apply; kTooLarge when areas hold more than `most_within` vertices. Cost: for
/// each area O(n).
tin::base::Result<tin::terrain::Terrain::Applied> apply(tin::terrain::Terrain& terrain,
                                                        const LatticeEdits& edits,
                                                        tin::terrain::Duplicates duplicates,
                                                        std::size_t most_within,
                                                        std::vector<AreaResult>& areas);

/// What becomes of a TIN's frame when its first vertices arrive: fitted to them with these lattice steps (0:
/// chosen).
using OpenResolution = std::optional<std::array<double, 2>>;

bool inserts_any(std::span<const WorldEdit> edits);

/// Errors: as frame::to_lattice; `where` is "/i".
tin::base::Result<LatticeEdits> to_lattice(std::span<const WorldEdit> edits, const tin::frame::Frame& frame);

/// The first vertices arrive: an empty terrain in a frame like `open`, but fitted to them. Errors: kNotFinite
/// at
/// "/i"; as gdal::read_crs and frame::fit_points.
tin::base::Result<std::shared_ptr<tin::terrain::Terrain>> fit_frame(const tin::frame::Frame& open,
                                                                    const std::array<double, 2>& resolution,
                                                                    std::span<const WorldEdit> edits);

}  // namespace server::app
