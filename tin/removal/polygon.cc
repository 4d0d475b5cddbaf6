#include "tin/removal/polygon.h"

#include <algorithm>

namespace tin::removal {

using exact::Int128;

void Polygon::start(std::uint32_t degree, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  if (triangles_.size() < degree) {
    triangles_.resize(degree);
    edges_.resize(degree);
  }
  first_ = a;
  triangles_[a] = {{a, b, c}, {kNowhere, kNowhere, kNowhere}};
  edges_[b] = a << 2;
  edges_[c] = (a << 2) + 1;
  edges_[a] = (a << 2) + 2;
}

void Polygon::link(Side a, Side b) {
  triangles_[a >> 2].twins[a & 3] = b;
  triangles_[b >> 2].twins[b & 3] = a;
}

void Polygon::enlarge() {
  room_ = room_ == 0 ? 64 : 2 * room_;
  cavity_.resize(room_ + 1);
  corners_.resize(room_ + 2);
  rim_.resize(room_ + 2);
  to_cross_.resize(2 * room_ + 1);
}

/// Field by field: a copy of the whole would be read from where its parts are still being written.
inline void Polygon::see(const Star& star, std::uint32_t position, std::uint32_t m, Corner& corner) {
  corner.position = position;
  if (position == star.infinite()) [[unlikely]] {
    corner.x = corner.y = 0;
    corner.z = 1;
    return;
  }
  const exact::Lifted &at = star.at(position), &origin = star.at(m);
  corner.x = at.x - origin.x;
  corner.y = at.y - origin.y;
  corner.z = at.z - origin.z;
}

/// Collects the triangles in conflict with `m`, breadth first, and returns their number. Nothing branches on
/// what a test finds: a triangle's two other edges are always written, and count if it is in conflict. The
/// edges that stay are the last ones written for each corner.
template <class Tally>
std::size_t Polygon::find_cavity(const Star& star, std::uint32_t before, std::uint32_t m, Tally& tally) {
  if (room_ == 0) enlarge();
  const bool finite = m != star.infinite();
  const Side entrance = edges_[before];
  const std::uint32_t after = to(entrance);
  see(star, after, m, corners_[0]);
  see(star, before, m, corners_[1]);
  to_cross_[0] = {corners_[0].x * corners_[1].y - corners_[0].y * corners_[1].x, entrance, 0, 1};
  std::size_t count = 0;
  for (std::size_t i = 0; i < 2 * count + 1; ++i) {
    const std::int64_t cross = to_cross_[i].cross;
    const Side beyond = to_cross_[i].beyond;
    const std::uint32_t from_corner = to_cross_[i].from, to_corner = to_cross_[i].to;
    rim_[from_corner].beyond = beyond;
    rim_[from_corner].to = to_corner;
    if (beyond == kNowhere) continue;
    if (count == room_) [[unlikely]] enlarge();
    const Triangle& t = triangles_[beyond >> 2];
    const std::uint32_t j = beyond & 3;
    const auto middle = static_cast<std::uint32_t>(count + 2);
    Corner& apex = corners_[middle];
    see(star, t.corners[j], m, apex);
    const Corner &start = corners_[from_corner], &end = corners_[to_corner];
    const std::int64_t from_apex = start.x * apex.y - start.y * apex.x,
                       apex_to = apex.x * end.y - apex.y * end.x;
    cavity_[count] = beyond >> 2;
    to_cross_[2 * count + 1] = {from_apex, t.twins[kNext[j]], from_corner, middle};
    to_cross_[2 * count + 2] = {apex_to, t.twins[kPrevious[j]], middle, to_corner};
    const Int128 determinant = Int128{end.z} * from_apex + Int128{start.z} * apex_to - Int128{apex.z} * cross;
    bool conflict = determinant > 0;
    if (determinant == 0 || !finite) [[unlikely]] {
      NoCounters none;
      conflict = star.in_conflict(apex.position, end.position, start.position, m, none);
    }
    tally.in_circle_test();
    count += conflict ? 1 : 0;
  }
  return count;
}

template <class Tally>
void Polygon::insert(const Star& star, std::uint32_t before, std::uint32_t m, Tally& tally) {
  const std::size_t count = find_cavity(star, before, m, tally);
  cavity_[count] = m;  // one triangle more than make way
  Side open = kNowhere;  // the last triangle's side towards the next one
  std::uint32_t at = 0;
  for (std::size_t i = 0; i <= count; ++i) {
    const Side side = cavity_[i] << 2;
    const std::uint32_t start = corners_[at].position;
    const Side beyond = rim_[at].beyond;
    at = rim_[at].to;
    triangles_[cavity_[i]] = {{m, start, corners_[at].position}, {kNowhere, kNowhere, kNowhere}};
    if (beyond == kNowhere) edges_[start] = side; else link(side, beyond);
    if (i == 0) edges_[m] = side + 2; else link(open, side + 2);
    open = side + 1;
  }
  edges_[before] = open;
}

/// Goes down the dual tree from some edge of the polygon; a triangle is an ear once those behind it are cut.
void Polygon::append_ears(std::vector<Ear>& ears) {
  const std::size_t first = ears.size();
  stack_.assign(1, edges_[triangles_[first_].corners[0]]);
  while (!stack_.empty()) {
    const Side side = stack_.back();
    stack_.pop_back();
    const Triangle& t = triangles_[side >> 2];
    const std::uint32_t j = side & 3;
    ears.push_back({to(side), t.corners[j], from(side)});
    if (t.twins[kNext[j]] != kNowhere) stack_.push_back(t.twins[kNext[j]]);
    if (t.twins[kPrevious[j]] != kNowhere) stack_.push_back(t.twins[kPrevious[j]]);
  }
  std::reverse(ears.begin() + static_cast<std::ptrdiff_t>(first), ears.end());
}

template void Polygon::insert(const Star&, std::uint32_t, std::uint32_t, NoCounters&);
template void Polygon::insert(const Star&, std::uint32_t, std::uint32_t, Counters&);

}  // namespace tin::removal
