// The dynamic Delaunay triangulation: insert, remove, locate; canonical after every operation.
//
//   Triangulation t;
//   auto [a, fresh] = t.insert({0, 0});
//   t.insert({10, 0}); t.insert({0, 10});
//   t.remove(a);                       // back to what it was without a, link by link
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tin/base/progress.h"
#include "tin/delaunay/start_grid.h"
#include "tin/exact/point.h"
#include "tin/mesh/mesh.h"
#include "tin/removal/remover.h"

namespace tin::delaunay {

/// Where a lattice point lies.
struct Location {
  enum class Kind {
    kOutsideHull,     // `triangle` is infinite (dimension 2), or the mesh has fewer dimensions
    kInTriangle,      // strictly inside `triangle`
    kOnEdge,          // on the edge of `triangle` opposite to vertex `index`
    kOnVertex,        // at `vertex`
  };
  Kind kind = Kind::kOutsideHull;
  mesh::TriangleSlot triangle{mesh::kNone};
  int index = -1;
  mesh::VertexSlot vertex{mesh::kNone};
};

class Triangulation {
 public:
  struct Inserted {
    mesh::VertexSlot vertex;
    bool fresh;  // false: a vertex stood there already
  };

  const mesh::Mesh& mesh() const { return mesh_; }

  /// Inserts `p` anywhere: inside, on an edge, outside the hull, into a mesh of any dimension.
  /// Requires: p on the lattice. Cost: location, then expected O(1) on random input; the star's size at worst.
  Inserted insert(exact::Point p);
  /// The same, starting the walk at an alive vertex that is likely near.
  Inserted insert_near(exact::Point p, mesh::VertexSlot hint);

  /// Removes `v`. Requires: v alive. Cost: expected O(k) for degree k.
  void remove(mesh::VertexSlot v);

  /// Inserts many points, in Hilbert order; slots[i] is the vertex of points[i] (equal for equal points).
  /// Returns false, and leaves an incomplete triangulation to be thrown away, when `progress` was cancelled.
  bool insert_many(std::span<const exact::Point> points, std::vector<mesh::VertexSlot>& slots,
                   base::Progress* progress = nullptr);

  /// Walks to `p` from a remembered vertex near it. Const and safe beside other readers.
  Location locate(exact::Point p) const;
  /// Walks from `hint`, any alive triangle (dimension 2).
  Location locate_from(exact::Point p, mesh::TriangleSlot hint) const;

  /// Triangles (with infinite ones) made by the last insert or remove, for callers that keep data per triangle.
  std::span<const mesh::TriangleSlot> fresh_triangles() const { return fresh_; }

 private:
  Inserted insert_located(exact::Point p, const Location& where);
  Inserted insert_below_plane(exact::Point p);
  void raise_to_plane(mesh::VertexSlot apex);
  void drop_to_line(mesh::VertexSlot gone);
  bool in_conflict(mesh::TriangleSlot t, exact::Point p) const;
  void find_cavity(exact::Point p, mesh::TriangleSlot first);
  void fill_cavity(mesh::VertexSlot v);
  Location classify(exact::Point p, mesh::TriangleSlot t) const;

  mesh::Mesh mesh_;
  StartGrid starts_;
  removal::Remover remover_;
  std::vector<mesh::TriangleSlot> fresh_;
  std::vector<mesh::TriangleSlot> cavity_;     // triangles in conflict with the new point
  std::vector<mesh::HalfEdge> cavity_edge_;    // around them, counter-clockwise, seen from outside
  std::vector<mesh::HalfEdge> to_cross_;
};

}  // namespace tin::delaunay
