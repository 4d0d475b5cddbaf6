// Which triangles an edit made. The mesh is a function of its vertices, so the edit's history does not
// matter: a triangle is new if a corner is, or if a vertex that is gone lay in its circle.
#include "tin/terrain/edited_area.h"

#include <algorithm>
#include <unordered_set>

#include "tin/exact/predicates.h"
#include "tin/terrain/terrain.h"

namespace tin::terrain {

using delaunay::Location;
using exact::Point;
using mesh::HalfEdge;
using mesh::Mesh;
using mesh::TriangleSlot;
using mesh::VertexSlot;

namespace {

class AreaFinder {
 public:
  explicit AreaFinder(const Terrain& terrain) : terrain_(terrain), mesh_(terrain.mesh()) {}

  /// The star of a vertex that stands.
  void add_star(VertexSlot v) {
    mesh_.link(v, link_);
    for (const HalfEdge e : link_) found_.push_back(e.triangle());
  }

  /// All triangles in whose circle `p` lies, where no vertex stands.
  void add_conflicts(Point p) {
    const Location where = last_.value() != mesh::kNone && mesh_.is_alive(last_)
                               ? terrain_.triangulation().locate_from(p, last_)
                               : terrain_.triangulation().locate(p);
    last_ = where.triangle;
    if (where.kind == Location::Kind::kOnVertex) return;
    to_visit_.clear();
    seen_.clear();
    visit(p, where.kind == Location::Kind::kOutsideHull ? seen_from(p, where.triangle) : where.triangle);
    while (!to_visit_.empty()) {
      const TriangleSlot t = to_visit_.back();
      to_visit_.pop_back();
      found_.push_back(t);
      for (int i = 0; i < 3; ++i) visit(p, mesh_.twin(t, i).triangle());
    }
  }

  std::vector<EditedTriangle> take() {
    std::sort(found_.begin(), found_.end());
    found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
    std::vector<EditedTriangle> area;
    area.reserve(found_.size());
    for (const TriangleSlot t : found_) {
      if (!mesh_.is_infinite(t)) area.push_back(describe(t));
    }
    std::sort(area.begin(), area.end(),
              [](const EditedTriangle& a, const EditedTriangle& b) { return a.corners < b.corners; });
    return area;
  }

 private:
  void visit(Point p, TriangleSlot t) {
    if (seen_.contains(t) || !is_in_conflict(p, t)) return;
    seen_.insert(t);
    to_visit_.push_back(t);
  }

  bool is_in_conflict(Point p, TriangleSlot t) const {
    if (!mesh_.is_infinite(t)) {
      const auto& v = mesh_.triangle(t).vertices;
      return exact::in_circle(mesh_.point(v[0]), mesh_.point(v[1]), mesh_.point(v[2]), p);
    }
    // The infinite triangle runs counter-clockwise, so the terrain is on the right of its edge.
    const int at = mesh_.index_of(t, mesh::kInfinite);
    const Point from = mesh_.point(mesh_.vertex(t, mesh::next3(at))),
                to = mesh_.point(mesh_.vertex(t, mesh::prev3(at)));
    const std::int64_t side = exact::orientation(from, to, p);
    return side > 0 || (side == 0 && std::min(from, to) < p && p < std::max(from, to));
  }

  /// An infinite triangle whose edge is seen from `p`, which lies outside.
  TriangleSlot seen_from(Point p, TriangleSlot infinite) const {
    TriangleSlot t = infinite;
    while (!is_in_conflict(p, t)) {
      t = mesh_.twin(t, mesh::next3(mesh_.index_of(t, mesh::kInfinite))).triangle();
      TIN_CHECK(t != infinite);
    }
    return t;
  }

  EditedTriangle describe(TriangleSlot t) const {
    EditedTriangle out;
    for (int i = 0; i < 3; ++i) {
      out.corners[static_cast<std::size_t>(i)] = mesh_.point(mesh_.vertex(t, i));
      if (std::binary_search(found_.begin(), found_.end(), mesh_.twin(t, i).triangle()))
        out.inner |= static_cast<std::uint8_t>(1U << i);
    }
    return with_least_first(out);
  }

  const Terrain& terrain_;
  const Mesh& mesh_;
  TriangleSlot last_{mesh::kNone};
  std::vector<HalfEdge> link_;
  std::vector<TriangleSlot> found_, to_visit_;  // infinite ones among them: edges of the outline that changed
  std::unordered_set<TriangleSlot> seen_;
};

}  // namespace

EditedTriangle with_least_first(const EditedTriangle& t) {
  const auto first = static_cast<std::size_t>(std::min_element(t.corners.begin(), t.corners.end()) - t.corners.begin());
  EditedTriangle out;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t from = (first + i) % 3;
    out.corners[i] = t.corners[from];
    if ((t.inner >> from & 1U) != 0) out.inner |= static_cast<std::uint8_t>(1U << i);
  }
  return out;
}

std::vector<Step> net_steps(const Change& change) {
  std::vector<Step> steps = change.steps;
  std::stable_sort(steps.begin(), steps.end(), [](const Step& a, const Step& b) { return a.id < b.id; });
  std::vector<Step> out;
  for (std::size_t i = 0; i < steps.size();) {
    std::size_t last = i;
    while (last + 1 < steps.size() && steps[last + 1].id == steps[i].id) ++last;
    if (steps[i].before != steps[last].after) out.push_back({steps[i].id, steps[i].before, steps[last].after});
    i = last + 1;
  }
  return out;
}

std::vector<EditedTriangle> edited_area(const Terrain& after, const Change& change) {
  if (after.mesh().dimension() < 2) return {};
  AreaFinder finder(after);
  for (const Step& step : net_steps(change)) {
    const auto slot = after.slot_of(step.id);
    if (step.after && slot) finder.add_star(*slot);
    if (step.before && (!step.after || step.after->at != step.before->at))
      finder.add_conflicts(step.before->at);
  }
  return finder.take();
}

bool is_inside(const EditedTriangle& t, Point p) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t side = exact::orientation(t.corners[(i + 1) % 3], t.corners[(i + 2) % 3], p);
    if (side < 0 || (side == 0 && ((t.inner >> i) & 1U) == 0)) return false;
  }
  return p != t.corners[0] && p != t.corners[1] && p != t.corners[2];
}

std::pair<Point, Point> box(const EditedTriangle& t) {
  const auto& [a, b, c] = t.corners;
  return {{std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y})},
          {std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y})}};
}

}  // namespace tin::terrain
