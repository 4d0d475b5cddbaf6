// The simplify process: works on a version while edits go on, certifies against the samples that the TIN was
// made of, and lands as one revision or as a new TIN.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/app/catalogue.h"
#include "tin/query/region.h"
#include "tin/simplify/simplify.h"

namespace server::app {

/// Vertices that stay, as asked for.
struct Protection {
  using Polygon = std::vector<tin::query::Ring>;  // on the lattice; what is inside, tin::query::Inside says
  bool border = false;
  std::vector<VertexId> ids;
  std::vector<Polygon> polygons;

  bool empty() const { return !border && ids.empty() && polygons.empty(); }
};

/// Where they stand. Ids that are not there do not count. Cost: the vertices times the polygons' corners near
/// them.
std::vector<tin::exact::Point> protected_positions(const tin::terrain::Terrain& terrain,
                                                   const Protection& protection);

struct SimplifyRequest {
  std::shared_ptr<Tin> tin;
  tin::simplify::Options options;
  std::optional<double> max_seconds;
  Protection protect;
  std::optional<std::string> as;  // id of the TIN to make; nothing: the TIN itself gets a new revision
};

struct Simplified {
  tin::simplify::Report report;
  bool against_source = false;   // else against the vertices and those that simplifications took away
  std::size_t out_of_force = 0;  // samples of the source that edits put out of force
  std::shared_ptr<Tin> tin;      // the one that holds the result
  std::uint64_t revision = 0;    // of it
  double seconds = 0;
  bool out_of_time = false;  // max_seconds ended the search
  /// Others edited the TIN meanwhile: their edits stand. Where the tolerance was met, samples that it needs
  /// beside them have become vertices again, and the report speaks of the revision; else of the version that
  /// was simplified.
  bool edited_meanwhile = false;
};

/// Errors: as simplify::simplify, Catalogue::create, Tin::source and Tin::land; kTooLarge, kTooMany, kNoSpace
/// (no memory, or no room for temporary files); a cancelled or failed job changes nothing.
tin::base::Result<Simplified> simplify_tin(Catalogue& catalogue, const SimplifyRequest& request,
                                           tin::base::Progress& progress);

}  // namespace server::app
