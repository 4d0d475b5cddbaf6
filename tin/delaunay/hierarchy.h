// Where a walk should start, the sure way: a Delaunay hierarchy (Devillers, "The Delaunay hierarchy", IJFCS
// 2002; reference [6] of the paper on deletion). Level k holds about one vertex in 64^k, chosen by a hash of
// its coordinates, as a Delaunay triangulation of its own. The search goes from the top down, from each level
// to the vertex found in the next.
//
// Which vertices a level holds is a function of the vertex set alone, whatever its distribution and its
// history: levels need no care when vertices go. Expected cost: a walk of O(1) triangles per level, O(log n)
// levels.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tin/delaunay/layer.h"

namespace tin::delaunay {

class Hierarchy {
 public:
  /// How many levels above the base hold a vertex at `p`.
  static std::size_t height_of(exact::Point p) {
    return static_cast<std::size_t>(std::countr_zero(scramble(p)) / kBitsPerLevel);
  }

  /// The base vertex stored in `slot` at `p` has come; or goes, while the base may or may not have it any
  /// more.
  void add(exact::Point p, mesh::VertexSlot slot) {
    if (const std::size_t height = height_of(p); height > 0) [[unlikely]] add_to_levels(p, slot, height);
  }
  void remove(exact::Point p) {
    if (const std::size_t height = height_of(p); height > 0) [[unlikely]] remove_from_levels(p, height);
  }
  /// Starts anew with all vertices of `base`, whose slots follow the Hilbert curve.
  void build(const mesh::Mesh& base);
  /// The base's slots have changed.
  void renumber(const std::vector<mesh::VertexSlot>& new_of_old);

  /// A base vertex near `p`; kNone when the levels are empty. `steps` grows by the number of triangles
  /// crossed.
  mesh::VertexSlot near(exact::Point p, std::uint64_t& steps) const;

  std::size_t bytes() const;
  /// The levels' meshes, lowest first, for tests.
  std::size_t levels() const { return levels_.size(); }
  const mesh::Mesh& level(std::size_t k) const { return levels_[k].layer.mesh(); }

 private:
  struct Level {
    Layer layer;
    std::vector<mesh::VertexSlot>
        below;  // by slot: the same vertex one level down, in the base for the lowest level
  };
  struct Found {
    mesh::VertexSlot vertex;  // near the place, or at it; kNone in an empty level
    bool exact;
  };

  static constexpr int kBitsPerLevel = 6;

  static std::uint64_t scramble(exact::Point p) {
    std::uint64_t x =
        static_cast<std::uint64_t>(static_cast<std::uint32_t>(p.x)) << 32 | static_cast<std::uint32_t>(p.y);
    x = (x ^ (x >> 31)) * 0x7fb5d329728ea185ULL;
    x = (x ^ (x >> 27)) * 0x81dadef4bc2dd44dULL;
    return x ^ (x >> 33);
  }

  void add_to_levels(exact::Point p, mesh::VertexSlot slot, std::size_t height);
  void remove_from_levels(exact::Point p, std::size_t height);
  /// Calls visit(k, found) for each level from the top down. Returns the base vertex found in the end, or
  /// kNone.
  template <class Visit>
  mesh::VertexSlot descend(exact::Point p, std::uint64_t& steps, const Visit& visit) const;
  static Found find(const mesh::Mesh& mesh, exact::Point p, mesh::VertexSlot from, std::uint64_t& steps);

  std::vector<Level> levels_;
};

}  // namespace tin::delaunay
