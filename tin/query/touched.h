// Where a change altered the surface: a box outside which every triangle is what it was.
#pragma once

#include <optional>

#include "tin/terrain/terrain.h"

namespace tin::query {

struct TouchedArea {
  terrain::Box box;
  bool hull = false;  // the outline may have changed
};

/// The area that `change` touched, seen from the terrain after it. Nothing: it is not known, so it may be everything (a change of
/// very many vertices, a terrain without triangles).
///
/// A triangle of the new mesh is new, or has a new height, only if it has a vertex that the change put there, or if its circle
/// holds a position where a vertex stood before; and what is covered no longer lies between the new outline and such positions.
/// Cost: O(triangles in the box's parts).
std::optional<TouchedArea> touched_area(const terrain::Terrain& after, const terrain::Change& change);

}  // namespace tin::query
