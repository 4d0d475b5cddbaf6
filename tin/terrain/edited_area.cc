// Which triangles an edit made. The mesh is a function of its vertices, so the edit's history does not
// matter: a triangle is new if a corner is, or if a vertex that is gone lay in its circle.
#include <algorithm>
#include <unordered_set>

#include "tin/exact/predicates.h"
#include "tin/terrain/amendments.h"
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
    for (const HalfEdge e : link_) add(e.triangle());
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
    if (where.kind == Location::Kind::kOutsideHull) {
      start_outside(p, where.triangle);
    } else {
      visit(p, where.triangle);
    }
    while (!to_visit_.empty()) {
      const TriangleSlot t = to_visit_.back();
      to_visit_.pop_back();
      add(t);
      for (int i = 0; i < 3; ++i) visit(p, mesh_.twin(t, i).triangle());
    }
  }

  std::vector<EditedTriangle> take() {
    std::sort(found_.begin(), found_.end());
    found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
    std::vector<EditedTriangle> area;
    area.reserve(found_.size());
    for (const TriangleSlot t : found_) area.push_back(describe(t));
    return area;
  }

 private:
  void add(TriangleSlot t) {
    if (!mesh_.is_infinite(t)) found_.push_back(t);
  }

  void visit(Point p, TriangleSlot t) {
    if (mesh_.is_infinite(t) || seen_.contains(t)) return;
    const auto& v = mesh_.triangle(t).vertices;
    if (!exact::in_circle(mesh_.point(v[0]), mesh_.point(v[1]), mesh_.point(v[2]), p)) return;
    seen_.insert(t);
    to_visit_.push_back(t);
  }

  /// Behind each hull edge that is seen from `p`, if only from its end.
  void start_outside(Point p, TriangleSlot infinite) {
    for (const int side : {1, -1}) {
      TriangleSlot t = infinite;
      for (;;) {
        const int at = mesh_.index_of(t, mesh::kInfinite);
        const VertexSlot from = mesh_.vertex(t, mesh::next3(at)), to = mesh_.vertex(t, mesh::prev3(at));
        // The infinite triangle runs counter-clockwise, so the terrain is on the right of its edge.
        if (exact::orientation(mesh_.point(from), mesh_.point(to), p) < 0) break;
        visit(p, mesh_.twin(t, at).triangle());
        t = mesh_.twin(t, side > 0 ? mesh::next3(at) : mesh::prev3(at)).triangle();
        if (t == infinite) break;
      }
    }
  }

  EditedTriangle describe(TriangleSlot t) const {
    EditedTriangle out;
    for (int i = 0; i < 3; ++i) {
      out.corners[static_cast<std::size_t>(i)] = mesh_.point(mesh_.vertex(t, i));
      if (std::binary_search(found_.begin(), found_.end(), mesh_.twin(t, i).triangle()))
        out.inner |= static_cast<std::uint8_t>(1U << i);
    }
    return out;
  }

  const Terrain& terrain_;
  const Mesh& mesh_;
  TriangleSlot last_{mesh::kNone};
  std::vector<HalfEdge> link_;
  std::vector<TriangleSlot> found_, to_visit_;
  std::unordered_set<TriangleSlot> seen_;
};

}  // namespace

std::vector<EditedTriangle> edited_area(const Terrain& after, const Change& change) {
  if (after.mesh().dimension() < 2) return {};
  AreaFinder finder(after);
  for (const Step& step : change.steps) {
    const auto slot = after.slot_of(step.id);
    if (step.after && slot) finder.add_star(*slot);
    if (step.before && (!step.after || step.after->at != step.before->at))
      finder.add_conflicts(step.before->at);
  }
  return finder.take();
}

}  // namespace tin::terrain
