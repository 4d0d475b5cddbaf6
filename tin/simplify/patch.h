// A piece of the simplified TIN while it is being made, small enough for the caches: the canonical
// triangulation of the vertices in some part of the ground, which the patch owns, and of those linked to
// them, which are frozen.
//
// Every triangle that has an owned vertex is one of the whole TIN, since the owned vertices' stars are
// complete. So a change that touches only triangles among owned vertices is the same change in the whole TIN,
// and patches of different owners can be worked on at the same time; what would touch others is refused.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tin/delaunay/cavity.h"
#include "tin/mesh/mesh.h"
#include "tin/mesh/page_allocator.h"
#include "tin/removal/remover.h"
#include "tin/simplify/samples.h"

namespace tin::simplify {

/// A vertex of the TIN between the rounds of work on it.
struct Pin {
  double z = 0;  // its height: the sample's, but where elevations are fitted
  SampleIndex sample = 0;
  bool fixed = false;    // never goes: a corner of the hull, or protected
  bool settled = false;  // its removal was tried in vain, and its star is still the same
};

class Patch {
 public:
  /// Borrows `samples`. Building uses up to `threads` threads.
  Patch(const Samples& samples, std::span<const Pin> frozen, std::span<const Pin> owned,
        unsigned threads = 1);
  ~Patch() { note_vertices(); }
  Patch(const Patch&) = delete;
  Patch& operator=(const Patch&) = delete;

  const Samples& samples() const { return *samples_; }
  const mesh::Mesh& mesh() const { return mesh_; }
  const Site& site(mesh::VertexSlot v) const { return sites_[v.value()]; }
  bool owns(mesh::VertexSlot v) const { return owner_.owns(v); }
  /// Alive, finite and among owned vertices.
  bool owns(mesh::TriangleSlot t) const {
    const auto& v = mesh_.triangle(t).vertices;
    return mesh_.is_alive(t) && !mesh_.is_infinite(t) && owns(v[0]) && owns(v[1]) && owns(v[2]);
  }
  bool is_fixed(mesh::VertexSlot v) const { return (flags_[v.value()] & kFixed) != 0; }
  bool is_settled(mesh::VertexSlot v) const { return (flags_[v.value()] & kSettled) != 0; }
  void settle(mesh::VertexSlot v) { flags_[v.value()] |= kSettled; }
  void unsettle(mesh::VertexSlot v) {
    if (notes_ != nullptr && is_settled(v)) notes_->push_back(v);
    flags_[v.value()] &= static_cast<std::uint8_t>(~kSettled);
  }
  /// From now on vertices that were settled and are no more are noted there; null: nowhere.
  void note_unsettled(std::vector<mesh::VertexSlot>* notes) { notes_ = notes; }
  /// Owned vertices have slots from here on.
  std::uint32_t first_owned() const { return owner_.first; }
  std::size_t owned_count() const { return mesh_.vertex_count() - (owner_.first - 1); }

  /// Makes the sample at `site` a vertex; `near` is a finite triangle to look for it from. Nothing, and no
  /// change, when a vertex stands there, when it is outside the hull, or when triangles would be touched that
  /// are not the patch's own.
  std::optional<mesh::VertexSlot> insert(const Site& site, mesh::TriangleSlot near);
  /// The first half of insert(), which changes nothing: whether it would be done.
  bool carve(const Site& site, mesh::TriangleSlot near);
  /// After carve(): calls visit(from, to) for each side of the star that the vertex would have, until it
  /// returns false. Returns whether all were visited.
  template <class Visit>
  bool visit_carved(const Visit& visit) const {
    return cavity_.visit_rim(visit);
  }
  /// The second half. Requires: carve() said yes to this site's position, and nothing has changed since.
  mesh::VertexSlot fill(const Site& site);
  /// Whether the patch may remove the alive vertex: it is not fixed, and its star is the patch's own.
  bool is_removable(mesh::VertexSlot v) const;
  /// False, and no change, when only collinear vertices would be left. Requires: is_removable(v).
  bool remove(mesh::VertexSlot v);
  /// Gives a vertex another height. Requires: its star is the patch's own.
  void set_height(mesh::VertexSlot v, double z);
  /// Whether all triangles at an alive, owned vertex are the patch's own, so that what it does changes no
  /// others.
  bool has_star(mesh::VertexSlot v) const;
  /// Triangles made or bent by the last change, infinite ones among them.
  std::span<const mesh::TriangleSlot> fresh() const { return fresh_; }

  /// Asks the samples over a finite triangle.
  Scan scan(mesh::TriangleSlot t, double tolerance, Depth depth) const {
    const auto& v = mesh_.triangle(t).vertices;
    return samples_->scan(site(v[0]), site(v[1]), site(v[2]), tolerance, depth);
  }

  /// Appends the owned vertices, by slot.
  void collect(std::vector<Pin>& out) const;

 private:
  static constexpr std::uint8_t kFixed = 1, kSettled = 2;
  static constexpr std::int64_t kNotedLate =
      64;  // vertices more or fewer that the samples' footprint is told of together

  void put(mesh::VertexSlot v, const Site& site);
  void note_vertices();

  const Samples* samples_;
  delaunay::OwnedFrom owner_;
  mesh::Mesh mesh_;
  delaunay::Cavity cavity_;
  mesh::VertexSlot beside_ = mesh::kInfinite;  // what was carved
  removal::Remover remover_;
  mesh::PageVector<Site> sites_;     // by vertex slot
  std::vector<std::uint8_t> flags_;  // the same
  std::vector<mesh::TriangleSlot> fresh_;
  std::vector<mesh::VertexSlot>* notes_ = nullptr;
  std::int64_t not_noted_ = 0;
};

}  // namespace tin::simplify
