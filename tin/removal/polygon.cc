#include "tin/removal/polygon.h"

#include <algorithm>

namespace tin::removal {

void Polygon::start(std::uint32_t degree, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  triangles_.clear();
  triangles_.reserve(degree - 2);
  triangles_.push_back({{a, b, c}, {kNowhere, kNowhere, kNowhere}});
  edges_.resize(degree);
  edges_[b] = 0;
  edges_[c] = 1;
  edges_[a] = 2;
}

void Polygon::link(Side a, Side b) {
  triangles_[a >> 2].twins[a & 3] = b;
  triangles_[b >> 2].twins[b & 3] = a;
}

/// Collects the triangles in conflict with `m`, depth first and counter-clockwise, so that the rim comes in order.
template <class Tally>
void Polygon::find_cavity(const Star& star, std::uint32_t before, std::uint32_t m, Tally& tally) {
  cavity_.clear();
  rim_.clear();
  const Side entrance = edges_[before];
  to_cross_.assign(1, {to(entrance), before, entrance});
  while (!to_cross_.empty()) {
    const Rim edge = to_cross_.back();
    to_cross_.pop_back();
    if (edge.beyond == kNowhere) {
      rim_.push_back(edge);
      continue;
    }
    const Triangle& t = triangles_[edge.beyond >> 2];
    const auto& [a, b, c] = t.corners;
    if (!star.in_conflict(a, b, c, m, tally)) {
      rim_.push_back(edge);
      continue;
    }
    const std::uint32_t j = edge.beyond & 3;
    cavity_.push_back(edge.beyond >> 2);
    to_cross_.push_back({t.corners[j], edge.to, t.twins[kPrevious[j]]});
    to_cross_.push_back({edge.from, t.corners[j], t.twins[kNext[j]]});
  }
}

template <class Tally>
void Polygon::insert(const Star& star, std::uint32_t before, std::uint32_t m, Tally& tally) {
  find_cavity(star, before, m, tally);
  cavity_.push_back(static_cast<std::uint32_t>(triangles_.size()));  // one triangle more than make way
  triangles_.emplace_back();
  Side open = kNowhere;  // the last triangle's side towards the next one
  for (std::size_t i = 0; i < rim_.size(); ++i) {
    const Side side = cavity_[i] << 2;
    const Rim& edge = rim_[i];
    triangles_[cavity_[i]] = {{m, edge.from, edge.to}, {kNowhere, kNowhere, kNowhere}};
    if (edge.beyond == kNowhere) edges_[edge.from] = side; else link(side, edge.beyond);
    if (i == 0) edges_[m] = side + 2; else link(open, side + 2);
    open = side + 1;
  }
  edges_[before] = open;
}

/// Goes down the dual tree from some edge of the polygon; a triangle is an ear once those behind it are cut.
void Polygon::append_ears(std::vector<Ear>& ears) {
  const std::size_t first = ears.size();
  cavity_.assign(1, edges_[triangles_[0].corners[0]]);
  while (!cavity_.empty()) {
    const Side side = cavity_.back();
    cavity_.pop_back();
    const Triangle& t = triangles_[side >> 2];
    const std::uint32_t j = side & 3;
    ears.push_back({to(side), t.corners[j], from(side)});
    if (t.twins[kNext[j]] != kNowhere) cavity_.push_back(t.twins[kNext[j]]);
    if (t.twins[kPrevious[j]] != kNowhere) cavity_.push_back(t.twins[kPrevious[j]]);
  }
  std::reverse(ears.begin() + static_cast<std::ptrdiff_t>(first), ears.end());
}

template void Polygon::insert(const Star&, std::uint32_t, std::uint32_t, NoCounters&);
template void Polygon::insert(const Star&, std::uint32_t, std::uint32_t, Counters&);

}  // namespace tin::removal
