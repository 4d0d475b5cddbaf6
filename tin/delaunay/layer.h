// A Delaunay triangulation that can be edited but has no idea where anything is: a mesh of any dimension with
// the scratch space for insertion and removal. A Triangulation is one of these with location on top; so is
// each of its coarser levels.
#pragma once

#include <span>
#include <vector>

#include "tin/delaunay/cavity.h"
#include "tin/exact/point.h"
#include "tin/mesh/mesh.h"
#include "tin/removal/remover.h"

namespace tin::delaunay {

class Layer {
 public:
  struct Inserted {
    mesh::VertexSlot vertex;
    bool fresh;  // false: a vertex stood there already
  };

  const mesh::Mesh& mesh() const { return mesh_; }
  mesh::Mesh& mutable_mesh() { return mesh_; }

  /// Inserts `p` where a walk to it stopped. Requires: dimension 2, stop.kind != kGaveUp.
  Inserted insert(exact::Point p, const Stop& stop);
  /// Inserts `p` into a mesh of dimension < 2.
  Inserted insert_below_plane(exact::Point p);
  /// Requires: v alive.
  void remove(mesh::VertexSlot v);

  /// Triangles (with infinite ones) made by the last insert or remove.
  std::span<const mesh::TriangleSlot> fresh() const { return fresh_; }
  void forget_fresh() { fresh_.clear(); }

 private:
  void raise_to_plane(mesh::VertexSlot apex);
  void drop_to_line(mesh::VertexSlot gone);

  mesh::Mesh mesh_;
  Cavity cavity_;
  removal::Remover remover_;
  std::vector<mesh::TriangleSlot> fresh_;
};

}  // namespace tin::delaunay
