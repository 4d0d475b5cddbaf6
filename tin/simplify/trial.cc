#include "tin/simplify/trial.h"

#include <algorithm>
#include <array>

namespace tin::simplify {

std::optional<double> Trial::cost_of_removing(const Patch& patch, mesh::VertexSlot v, double tolerance) {
  double cost = 0;
  for (const removal::Ear& ear : remover_.fill(patch.mesh(), v)) {
    const std::array corners{remover_.link_vertex(ear.previous), remover_.link_vertex(ear.middle),
                             remover_.link_vertex(ear.next)};
    if (std::find(corners.begin(), corners.end(), mesh::kInfinite) != corners.end()) continue;
    const Scan scan = patch.samples().scan(patch.site(corners[0]), patch.site(corners[1]), patch.site(corners[2]), tolerance,
                                           Depth::kFirstOver);
    if (scan.over) return std::nullopt;
    cost = std::max(cost, scan.error);
  }
  return cost;
}

}  // namespace tin::simplify
