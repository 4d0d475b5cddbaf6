// The simplified TIN while it is being made: a canonical triangulation of some of the samples.
#pragma once

#include <span>
#include <vector>

#include "tin/delaunay/triangulation.h"
#include "tin/simplify/samples.h"

namespace tin::simplify {

class WorkingTin {
 public:
  /// Starts with the corners of the samples' convex hull, which never go. Borrows `samples`.
  WorkingTin(const Samples& samples, std::span<const SampleIndex> corners);

  const mesh::Mesh& mesh() const { return triangulation_.mesh(); }
  const delaunay::Triangulation& triangulation() const { return triangulation_; }
  std::size_t vertex_count() const { return mesh().vertex_count(); }
  const Site& site(mesh::VertexSlot v) const { return sites_[v.value()]; }
  bool is_corner(mesh::VertexSlot v) const { return v.value() <= corner_count_; }

  /// Requires: the sample is no vertex yet; `near` an alive vertex.
  mesh::VertexSlot insert(SampleIndex sample, mesh::VertexSlot near);
  /// Requires: alive, no corner.
  void remove(mesh::VertexSlot v);
  /// Triangles made by the last of these, infinite ones among them.
  std::span<const mesh::TriangleSlot> fresh_triangles() const { return triangulation_.fresh_triangles(); }

  /// Asks the samples over a finite triangle.
  Scan scan(mesh::TriangleSlot t, double tolerance, Depth depth) const {
    const auto& v = mesh().triangle(t).vertices;
    return samples_->scan(site(v[0]), site(v[1]), site(v[2]), tolerance, depth);
  }
  const Samples& samples() const { return *samples_; }

 private:
  void put(mesh::VertexSlot v, const Site& site);

  const Samples* samples_;
  delaunay::Triangulation triangulation_;
  std::vector<Site> sites_;  // by vertex slot
  std::size_t corner_count_;
};

}  // namespace tin::simplify
