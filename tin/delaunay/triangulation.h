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
#include "tin/delaunay/hierarchy.h"
#include "tin/delaunay/hilbert_sort.h"
#include "tin/delaunay/layer.h"
#include "tin/delaunay/start_grid.h"
#include "tin/exact/point.h"
#include "tin/mesh/mesh.h"

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
  using Inserted = Layer::Inserted;

  const mesh::Mesh& mesh() const { return base_.mesh(); }

  // Editing
  // -------------------------------------------------------------------------------------------------------

  /// Inserts `p` anywhere: inside, on an edge, outside the hull, into a mesh of any dimension.
  /// Requires: p on the lattice. Cost: location, then expected O(1) on random input; the star's size at
  /// worst.
  Inserted insert(exact::Point p);
  /// The same, starting the walk at an alive vertex that is likely near.
  Inserted insert_near(exact::Point p, mesh::VertexSlot hint);

  /// Removes `v` by the ear queue. Requires: v alive. Cost: O(k log k) for degree k.
  void remove(mesh::VertexSlot v);

  /// Triangles (with infinite ones) made by the last insert or remove, for callers that keep data per
  /// triangle; none after a batch.
  std::span<const mesh::TriangleSlot> fresh_triangles() const { return base_.fresh(); }

  // Batches: the mesh is canonical, so they do their work in the order that suits them
  // -----------------------------

  /// Inserts many points; slots[i] is the vertex of points[i] (equal for equal points). An empty
  /// triangulation is built on up to `threads` threads, with its vertices stored along the Hilbert curve, in
  /// the same slots for any number of threads. Returns false, and leaves an incomplete triangulation to be
  /// thrown away, when `progress` was cancelled.
  bool insert_many(std::span<const exact::Point> points, std::vector<mesh::VertexSlot>& slots,
                   base::Progress* progress = nullptr, unsigned threads = 1);

  /// Removes many vertices. Requires: alive, distinct. Returns false, with some of them removed, when
  /// `progress` was cancelled.
  bool remove_many(std::span<const mesh::VertexSlot> slots, base::Progress* progress = nullptr);
  /// The same in the given order, fetching ahead.
  bool remove_in_order(std::span<const mesh::VertexSlot> slots, base::Progress* progress = nullptr);

  /// Stores the vertices along the Hilbert curve without gaps, and the triangles after them: after mass
  /// deletion this gives the memory back. Callers that keep data per slot follow the renumbering. Cost: O(n).
  mesh::Renumbering compact();

  // Location: const and safe beside other readers
  // --------------------------------------------------------------------

  /// Expected O(log n) for any distribution and history. `steps`, if given, grows by the number of triangles
  /// crossed.
  Location locate(exact::Point p, std::uint64_t* steps = nullptr) const;
  /// Walks from `hint`, any alive triangle (dimension 2); the walk always ends.
  Location locate_from(exact::Point p, mesh::TriangleSlot hint) const;
  /// locations[i] is where points[i] lies: as locate(), with many walks under way at a time.
  void locate_many(std::span<const exact::Point> points, std::vector<Location>& locations) const;

  const Hierarchy& hierarchy() const { return hierarchy_; }
  /// What mesh and location structure occupy.
  std::size_t bytes() const { return mesh().bytes() + grid_.bytes() + hierarchy_.bytes(); }

 private:
  friend class ManyWalks;

  Stop find(exact::Point p, std::uint64_t& steps) const;
  Stop find_from_hint(exact::Point p, std::uint64_t& steps) const;
  Stop find_from_top(exact::Point p, std::uint64_t& steps) const;
  Inserted insert_at(exact::Point p, const Stop& stop);
  bool build(std::span<const exact::Point> points, std::vector<mesh::VertexSlot>& slots,
             base::Progress* progress, unsigned threads);
  bool insert_more(std::span<const exact::Point> points, std::vector<mesh::VertexSlot>& slots,
                   base::Progress* progress);
  void refresh_grid();
  void fetch_for_insertion(std::span<const exact::Point> points, std::span<const OnCurve> order,
                           std::size_t i) const;

  Layer base_;
  StartGrid grid_;
  Hierarchy hierarchy_;
};

}  // namespace tin::delaunay
