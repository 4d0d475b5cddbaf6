#include "tests/tin/query/voronoi.h"

#include <numeric>

namespace support {

namespace {

struct At {
  long double x, y;
};
using Cell = std::vector<At>;

/// What of the cell is nearer to `own` than to `other`, both relative to the origin.
Cell nearer(const Cell& cell, At own, At other) {
  const auto excess = [&](At q) {
    return (q.x - other.x) * (q.x - other.x) + (q.y - other.y) * (q.y - other.y) -
           (q.x - own.x) * (q.x - own.x) - (q.y - own.y) * (q.y - own.y);
  };
  Cell out;
  for (std::size_t i = 0; i < cell.size(); ++i) {
    const At a = cell[i], b = cell[(i + 1) % cell.size()];
    const long double at_a = excess(a), at_b = excess(b);
    if (at_a >= 0) out.push_back(a);
    if ((at_a > 0 && at_b < 0) || (at_a < 0 && at_b > 0)) {
      const long double part = at_a / (at_a - at_b);
      out.push_back({a.x + part * (b.x - a.x), a.y + part * (b.y - a.y)});
    }
  }
  return out;
}

long double area(const Cell& cell) {
  long double twice = 0;
  for (std::size_t i = 0; i < cell.size(); ++i) {
    const At a = cell[i], b = cell[(i + 1) % cell.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return twice / 2;
}

}  // namespace

std::vector<double> sibson_weights(const std::vector<tin::exact::Point>& points, tin::exact::Point p) {
  constexpr long double kFar = 1e7L;
  std::vector<At> at;
  for (const auto q : points)
    at.push_back({static_cast<long double>(q.x) - p.x, static_cast<long double>(q.y) - p.y});
  const Cell everything{{-kFar, -kFar}, {kFar, -kFar}, {kFar, kFar}, {-kFar, kFar}};
  Cell taken = everything;
  for (const At& q : at) taken = nearer(taken, {0, 0}, q);
  std::vector<double> weights;
  for (std::size_t i = 0; i < at.size(); ++i) {
    Cell part = taken;
    for (std::size_t j = 0; j < at.size() && !part.empty(); ++j) {
      if (j != i) part = nearer(part, at[i], at[j]);
    }
    weights.push_back(static_cast<double>(area(part) / area(taken)));
  }
  return weights;
}

}  // namespace support
