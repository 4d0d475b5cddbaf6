// What a simplification does to a terrain that others may have edited meanwhile.
#pragma once

#include <vector>

#include "tin/terrain/terrain.h"

namespace server::app {

using VertexId = tin::terrain::VertexId;

/// What a simplification does to the vertices of the version that it saw.
struct Thinning {
  std::vector<VertexId> removed;                  // ascending
  std::vector<tin::terrain::Placement> inserted;  // samples that become vertices again, by position
  std::vector<tin::terrain::Vertex> reset;        // vertices that get another height, by id

  bool empty() const { return removed.empty() && inserted.empty() && reset.empty(); }
};

/// `terrain` after it, built anew.
tin::terrain::Terrain thinned(const tin::terrain::Terrain& terrain, const Thinning& thinning);

/// A simplification as it fits the present vertices.
struct Fitting {
  std::vector<VertexId> removed;              // ascending
  std::vector<tin::terrain::Vertex> changed;  // with their new heights
  std::vector<tin::terrain::Vertex> added;    // with ids of their own
  tin::terrain::Change change;
};

/// What of a thinning of `seen` is possible in `now`. Vertices go before others come: a position is free by
/// then.
Fitting fit(const tin::terrain::Terrain& seen, const tin::terrain::Terrain& now, const Thinning& thinning);

/// `terrain` with the fitting done, built anew.
tin::terrain::Terrain rebuilt(const tin::terrain::Terrain& terrain, const Fitting& fitting);

}  // namespace server::app
