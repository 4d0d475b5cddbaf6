#include "tin/query/touched.h"

#include <algorithm>
#include <unordered_set>
#include <vector>

#include "tin/exact/predicates.h"

namespace tin::query {

using exact::Point;
using mesh::TriangleSlot;
using mesh::VertexSlot;

namespace {

/// More steps than these are not worth following one by one.
constexpr std::size_t kMostSteps = 4096;

class Toucher {
 public:
  explicit Toucher(const terrain::Terrain& after) : terrain_(after), mesh_(after.mesh()) {}

  void take(Point p) {
    if (!area_) area_ = TouchedArea{{p, p}, false};
    auto& [low, high] = area_->box;
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }

  /// The triangles at a vertex.
  void take_star(VertexSlot v) {
    take(mesh_.point(v));
    const TriangleSlot first = mesh_.triangle_at(v);
    TriangleSlot t = first;
    do {
      take(t);
      t = mesh_.twin(t, mesh::next3(mesh_.index_of(t, v))).triangle();
    } while (t != first);
  }

  /// The triangles that a vertex at `p`, where none is now, would replace.
  void take_cavity(Point p) {
    take(p);
    std::vector<TriangleSlot> open{terrain_.triangulation().locate(p).triangle};
    std::unordered_set<std::uint32_t> seen{open[0].value()};
    while (!open.empty()) {
      const TriangleSlot t = open.back();
      open.pop_back();
      take(t);
      for (int i = 0; i < 3; ++i) {
        const TriangleSlot other = mesh_.twin(t, i).triangle();
        if (in_conflict(other, p) && seen.insert(other.value()).second) open.push_back(other);
      }
    }
  }

  std::optional<TouchedArea> area() const { return area_; }

 private:
  void take(TriangleSlot t) {
    for (int i = 0; i < 3; ++i) {
      if (mesh_.vertex(t, i) != mesh::kInfinite) take(mesh_.point(mesh_.vertex(t, i)));
    }
    if (mesh_.is_infinite(t)) area_->hull = true;
  }

  bool in_conflict(TriangleSlot t, Point p) const {
    const auto point = [&](int i) { return mesh_.point(mesh_.vertex(t, i)); };
    if (!mesh_.is_infinite(t)) return exact::in_circle(point(0), point(1), point(2), p);
    const int i = mesh_.index_of(t, mesh::kInfinite);
    return exact::orientation(point(mesh::next3(i)), point(mesh::prev3(i)), p) > 0;  // beyond this edge of the hull
  }

  const terrain::Terrain& terrain_;
  const mesh::Mesh& mesh_;
  std::optional<TouchedArea> area_;
};

}  // namespace

std::optional<TouchedArea> touched_area(const terrain::Terrain& after, const terrain::Change& change) {
  if (change.steps.size() > kMostSteps || after.mesh().dimension() < 2) return std::nullopt;
  std::vector<Point> stood;
  Toucher toucher(after);
  for (const terrain::Step& step : change.steps) {
    if (step.before) stood.push_back(step.before->at);
    if (const auto slot = after.slot_of(step.id)) toucher.take_star(*slot);
  }
  std::sort(stood.begin(), stood.end());
  stood.erase(std::unique(stood.begin(), stood.end()), stood.end());
  for (const Point p : stood) {
    const auto where = after.triangulation().locate(p);
    if (where.kind == delaunay::Location::Kind::kOnVertex) {
      toucher.take_star(where.vertex);
    } else {
      toucher.take_cavity(p);
    }
  }
  return toucher.area();
}

}  // namespace tin::query
