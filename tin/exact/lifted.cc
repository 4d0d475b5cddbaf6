#include "tin/exact/lifted.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

namespace tin::exact {
namespace {

/// Ordered as the points are by (x, y): differences stay below 2^31.
std::int64_t key(const Lifted& q) { return q.x * (std::int64_t{1} << 31) + q.y; }

/// Four collinear points: the parity of the permutation that orders them.
[[gnu::cold, gnu::noinline]] int sign_on_line(std::array<std::int64_t, 4> keys) {
  int parity = 1;
  for (const auto& [i, j] : {std::pair{0U, 1U}, {2U, 3U}, {0U, 2U}, {1U, 3U}, {1U, 2U}}) {
    if (keys[j] <= keys[i]) continue;
    std::swap(keys[i], keys[j]);
    parity = -parity;
  }
  return parity;
}

}  // namespace

/// The largest of four points on a circle decides, since no three of them are collinear; if its coefficient
/// is zero, all four are. Grids ask this at every other test and its answers follow no pattern, hence no
/// branches.
int tie_sign(const Lifted& a, const Lifted& b, const Lifted& c, const Lifted& d) {
  const std::int64_t of_a = key(a), of_b = key(b), of_c = key(c), of_d = key(d);
  const bool a_or_b = std::max(of_a, of_b) > std::max(of_c, of_d);
  const bool a_leads = a_or_b & (of_a > of_b), b_leads = a_or_b & (of_a <= of_b);
  const bool c_leads = !a_or_b & (of_c > of_d), d_leads = !a_or_b & (of_c <= of_d);
  // d takes the place of the largest.
  const std::int64_t turn = orientation(a_leads ? d : a, b_leads ? d : b, c_leads ? d : c);
  if (turn == 0) [[unlikely]] return sign_on_line({of_a, of_b, of_c, of_d});
  return (turn > 0) == d_leads ? -1 : 1;
}

}  // namespace tin::exact
