#include "tin/exact/lifted.h"

#include <array>
#include <utility>

namespace tin::exact {
namespace {

bool is_larger(const Lifted& a, const Lifted& b) { return a.x != b.x ? a.x > b.x : a.y > b.y; }

}  // namespace

int tie_sign(const Lifted& a, const Lifted& b, const Lifted& c, const Lifted& d) {
  std::array<const Lifted*, 4> descending{&a, &b, &c, &d};
  int parity = 1;
  for (const auto& [i, j] : {std::pair{0U, 1U}, {2U, 3U}, {0U, 2U}, {1U, 3U}, {1U, 2U}}) {
    if (!is_larger(*descending[j], *descending[i])) continue;
    std::swap(descending[i], descending[j]);
    parity = -parity;
  }
  for (const Lifted* q : descending) {
    std::int64_t coefficient = 0;
    if (q == &a) coefficient = orientation(d, b, c);
    if (q == &b) coefficient = orientation(a, d, c);
    if (q == &c) coefficient = orientation(a, b, d);
    if (q == &d) coefficient = -orientation(a, b, c);
    if (coefficient != 0) return coefficient > 0 ? 1 : -1;
  }
  return parity;
}

}  // namespace tin::exact
