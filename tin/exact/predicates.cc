#include "tin/exact/predicates.h"

#include <algorithm>
#include <array>

namespace tin::exact {

bool tie_is_inside(Point a, Point b, Point c, Point p) {
  std::array<Point, 4> descending{a, b, c, p};
  std::sort(descending.begin(), descending.end(), [](Point l, Point r) { return r < l; });
  for (const Point q : descending) {
    if (q == p) return false;
    std::int64_t coefficient = 0;
    if (q == a) coefficient = orientation(p, b, c);
    if (q == b) coefficient = orientation(a, p, c);
    if (q == c) coefficient = orientation(a, b, p);
    if (coefficient != 0) return coefficient > 0;
  }
  return false;
}

}  // namespace tin::exact
