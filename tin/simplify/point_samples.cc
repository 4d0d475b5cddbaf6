#include "tin/simplify/point_samples.h"

#include <algorithm>

#include "tin/simplify/narrowing.h"
#include "tin/simplify/ranking.h"

namespace tin::simplify {

using exact::Point;

/// What a triangle covers.
struct PointSamples::Ground {
  std::array<Point, 3> corners;  // counter-clockwise
  Box box;

  Ground(const Site& a, const Site& b, const Site& c) {
    const bool left = exact::orientation(a.at, b.at, c.at) > 0;
    corners = {a.at, left ? b.at : c.at, left ? c.at : b.at};
    const auto [low_x, high_x] = std::minmax({a.at.x, b.at.x, c.at.x});
    const auto [low_y, high_y] = std::minmax({a.at.y, b.at.y, c.at.y});
    box = {{low_x, low_y}, {high_x, high_y}};
  }
};

PointSamples::PointSamples(std::vector<Facet::Corner> samples, SampleIndex first,
                           const base::Progress* progress, Footprint* footprint)
    : samples_(std::move(samples)), first_(first), progress_(progress), footprint_(footprint) {
  if (samples_.empty()) return;
  // Sorted first, so that the tree depends on the set alone.
  std::sort(samples_.begin(), samples_.end(), [](const auto& l, const auto& r) { return l.at < r.at; });
  build(0, 0, samples_.size());
}

void PointSamples::build(std::size_t node, std::size_t begin, std::size_t end) {
  if (progress_ != nullptr && progress_->cancelled()) return;
  Box box{samples_[begin].at, samples_[begin].at};
  for (std::size_t i = begin; i < end; ++i) {
    const Point p = samples_[i].at;
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y)};
  }
  if (node >= boxes_.size()) boxes_.resize(2 * node + 1);
  boxes_[node] = box;
  if (end - begin <= kLeaf) return;
  const std::size_t middle = begin + (end - begin) / 2;
  const bool by_x = box.high.x - box.low.x >= box.high.y - box.low.y;
  const auto at = [this](std::size_t i) { return samples_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end), [by_x](const auto& l, const auto& r) {
    return by_x ? l.at < r.at : std::pair(l.at.y, l.at.x) < std::pair(r.at.y, r.at.x);
  });
  build(2 * node + 1, begin, middle);
  build(2 * node + 2, middle, end);
}

Scan PointSamples::scan(const Site& a, const Site& b, const Site& c, double tolerance, Depth depth) const {
  if (samples_.empty()) return {};
  const Facet facet({a.at, a.z}, {b.at, b.z}, {c.at, c.z});
  Scan found;
  visit(Ground(a, b, c), 0, 0, samples_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto weights = facet.weights(samples_[i].at);
      if (!weights) continue;
      const auto verdict = facet.judge(*weights, samples_[i].z, tolerance);
      keep_worse(found, {verdict.error, first_ + static_cast<SampleIndex>(i), !verdict.within});
      if (found.over && depth == Depth::kFirstOver) return false;
    }
    return true;
  });
  return found;
}

void PointSamples::narrow(const Site& a, const Site& b, const Site& c, double tolerance, Heights& heights) const {
  if (samples_.empty()) return;
  LatticeNarrowing narrowing(a, b, c, tolerance);
  visit(Ground(a, b, c), 0, 0, samples_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) narrowing.take(samples_[i].at, samples_[i].z);
    return narrowing.any();
  });
  narrowing.narrow(heights);
}

/// Calls leaf(begin, end) for the leaves of a node that the triangle may meet, until it returns false: the answer is known.
template <class Leaf>
bool PointSamples::visit(const Ground& ground, std::size_t node, std::size_t begin, std::size_t end, const Leaf& leaf) const {
  const Box& box = boxes_[node];
  if (box.low.x > ground.box.high.x || box.low.y > ground.box.high.y || box.high.x < ground.box.low.x ||
      box.high.y < ground.box.low.y) {
    return true;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const Point from = ground.corners[i], to = ground.corners[i == 2 ? 0 : i + 1];
    // The corner of the box that is furthest to the left of the side.
    const Point furthest{to.y > from.y ? box.low.x : box.high.x, to.x > from.x ? box.high.y : box.low.y};
    if (exact::orientation(from, to, furthest) < 0) return true;
  }
  if (end - begin <= kLeaf) return leaf(begin, end);
  if (progress_ != nullptr && progress_->cancelled()) return false;
  const std::size_t middle = begin + (end - begin) / 2;
  return visit(ground, 2 * node + 1, begin, middle, leaf) && visit(ground, 2 * node + 2, middle, end, leaf);
}

Site PointSamples::site(SampleIndex sample) const {
  const Facet::Corner& own = samples_[sample - first_];
  return {own.at, -1, -1, own.z, sample};
}

Extent PointSamples::extent() const {
  Extent out;
  out.samples = samples_.size();
  if (!empty()) out.box = {boxes_[0].low, boxes_[0].high};
  return out;
}

std::optional<SampleIndex> PointSamples::find(Point p) const {
  std::optional<SampleIndex> found;
  visit_box({p, p}, [&](std::size_t i) { found = first_ + static_cast<SampleIndex>(i); });
  return found;
}

/// All of them: the hull is found quickly enough among a box's samples.
void PointSamples::outermost(const terrain::Box& box, std::vector<SampleIndex>& out) const {
  visit_box({box.min, box.max}, [&](std::size_t i) { out.push_back(first_ + static_cast<SampleIndex>(i)); });
}

/// Calls visit(i) for each sample in the closed box.
template <class Visit>
void PointSamples::visit_box(const Box& wanted, const Visit& visit) const {
  struct Part {
    std::size_t node, begin, end;
  };
  std::array<Part, 2 * 64> left;
  std::size_t count = 0;
  if (!empty()) left[count++] = {0, 0, samples_.size()};
  while (count > 0) {
    const auto [node, begin, end] = left[--count];
    const Box& box = boxes_[node];
    if (box.low.x > wanted.high.x || box.low.y > wanted.high.y || box.high.x < wanted.low.x || box.high.y < wanted.low.y) continue;
    if (end - begin > kLeaf) {
      const std::size_t middle = begin + (end - begin) / 2;
      left[count++] = {2 * node + 2, middle, end};
      left[count++] = {2 * node + 1, begin, middle};
      continue;
    }
    for (std::size_t i = begin; i < end; ++i) {
      const Point p = samples_[i].at;
      if (p.x >= wanted.low.x && p.x <= wanted.high.x && p.y >= wanted.low.y && p.y <= wanted.high.y) visit(i);
    }
  }
}

}  // namespace tin::simplify
