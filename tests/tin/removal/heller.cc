#include "tests/tin/removal/heller.h"

#include <algorithm>
#include <limits>

namespace removal_tests {
namespace {

using tin::exact::Lifted;
using tin::exact::orientation;

double squared_length(const Lifted& a, const Lifted& b) {
  const auto x = static_cast<double>(b.x - a.x), y = static_cast<double>(b.y - a.y);
  return x * x + y * y;
}

/// Four times the squared circumradius of a triangle: the product of its sides over twice its area, squared.
double circle_size(const Lifted& a, const Lifted& b, const Lifted& c) {
  const auto area = static_cast<double>(orientation(a, b, c));
  return squared_length(a, b) * squared_length(b, c) * squared_length(c, a) / (area * area);
}

/// Whether q lies in the closed triangle.
bool covers(const Lifted& a, const Lifted& b, const Lifted& c, const Lifted& q) {
  return orientation(a, b, q) >= 0 && orientation(b, c, q) >= 0 && orientation(c, a, q) >= 0;
}

}  // namespace

std::vector<tin::removal::Ear> heller_fill(const tin::removal::Star& star) {
  std::vector<std::uint32_t> polygon(star.degree());
  for (std::uint32_t i = 0; i < star.degree(); ++i) polygon[i] = i;
  std::vector<tin::removal::Ear> ears;
  while (polygon.size() >= 3) {
    const std::size_t n = polygon.size();
    std::size_t best = n;
    double smallest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i) {
      const std::uint32_t previous = polygon[(i + n - 1) % n], middle = polygon[i], next = polygon[(i + 1) % n];
      const Lifted &a = star.at(previous), &b = star.at(middle), &c = star.at(next);
      if (orientation(a, b, c) <= 0) continue;
      const bool crossed = std::any_of(polygon.begin(), polygon.end(), [&](std::uint32_t q) {
        return q != previous && q != middle && q != next && covers(a, b, c, star.at(q));
      });
      if (crossed || circle_size(a, b, c) >= smallest) continue;
      smallest = circle_size(a, b, c);
      best = i;
    }
    ears.push_back({polygon[(best + n - 1) % n], polygon[best], polygon[(best + 1) % n]});
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(best));
  }
  return ears;
}

}  // namespace removal_tests
