// Which triangles an edit made, and what lies inside the area that they cover.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "tin/exact/point.h"
#include "tin/terrain/edit.h"

namespace tin::terrain {

class Terrain;

/// A triangle whose surface is an edit's. `inner` has bit i set when the area goes on beyond the edge
/// opposite to corner i.
struct EditedTriangle {
  std::array<exact::Point, 3> corners;  // counter-clockwise, the least first
  std::uint8_t inner = 0;
  friend bool operator==(const EditedTriangle&, const EditedTriangle&) = default;
};

/// What the steps come to for each vertex that they leave otherwise than it was: by id.
std::vector<Step> net_steps(const Change& change);

/// The same triangle, its corners in their order from the least on.
EditedTriangle with_least_first(const EditedTriangle& t);

/// The finite triangles of `after` that the change made, or bent by giving a corner another height. They
/// cover all of the surface that it changed, but for what the terrain no longer covers. Requires: `after` has
/// taken it in. The order depends on the triangles only.
std::vector<EditedTriangle> edited_area(const Terrain& after, const Change& change);

/// Whether `p` is strictly inside the area that the triangle is a part of: in the triangle, and not on an edge
/// where the area ends.
bool is_inside(const EditedTriangle& t, exact::Point p);

/// The corners of the box around it: least, greatest.
std::pair<exact::Point, exact::Point> box(const EditedTriangle& t);

}  // namespace tin::terrain
