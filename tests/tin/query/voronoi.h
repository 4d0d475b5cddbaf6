// Sibson's weights by their definition: Voronoi cells cut out of a large square, one half-plane per vertex.
#pragma once

#include <vector>

#include "tin/exact/point.h"

namespace support {

/// weights[i] is what a cell at `p` would take from that of points[i], as a part of all that it takes.
/// O(n^2).
std::vector<double> sibson_weights(const std::vector<tin::exact::Point>& points, tin::exact::Point p);

}  // namespace support
