// Contour lines, exact on the surface.
//
//   ContourTracer tracer(terrain, levels, {});
//   for (ContourLine line; tracer.next(line);) draw(line);
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tin/base/result.h"
#include "tin/frame/ground.h"
#include "tin/query/voids.h"
#include "tin/terrain/terrain.h"

namespace tin::query {

/// Multiples of `interval`, counted from `base`, within the terrain's range of elevations, ascending.
/// Errors: kInvalidValue (an interval that is not above 0, or too small for the elevations to tell levels
/// apart), kTooLarge (more than `most`).
base::Result<std::vector<double>> contour_levels(const terrain::Terrain& terrain, double interval,
                                                 double base, std::size_t most);

struct ContourLine {
  double level = 0;
  bool closed = false;  // then the last place equals the first
  std::vector<frame::Place> places;
};

/// A box in lattice steps.
struct PlaceBox {
  frame::Place min, max;
};

struct ContourOptions {
  Voids voids = Voids::kKeep;
  std::optional<PlaceBox> box;  // lines are cut at its sides
};

/// Traces line after line, by level, with higher ground on the left. A vertex exactly on a level counts as
/// above it: so no line ever branches, each is a ring or ends at the hull, at a void or at the box, and level
/// ground at the level has the line along its lower border. Straight from edge to edge; a place lies on its
/// edge up to rounding, and equals the vertex where that is on the level. The lines, their order and where
/// rings begin depend on ids, positions and elevations only. Borrows the terrain. One thread. Memory: 12
/// bytes per triangle.
class ContourTracer {
 public:
  /// `levels` strictly ascending. Cost: O(triangles).
  ContourTracer(const terrain::Terrain& terrain, std::vector<double> levels, const ContourOptions& options);

  /// The next line; false after the last. Cost: O(triangles crossed), and once per level those that have it
  /// in their range.
  bool next(ContourLine& line);
  /// Levels that are done, as a part of all.
  double fraction() const;

 private:
  struct Path;

  void sort_by_level();
  bool begin_level();
  bool crosses(mesh::TriangleSlot t) const;
  bool above(mesh::VertexSlot v) const { return terrain_.z(v) >= level_; }
  mesh::HalfEdge entry(mesh::TriangleSlot t) const;
  mesh::HalfEdge exit(mesh::TriangleSlot t) const;
  frame::Place crossing(mesh::HalfEdge edge) const;
  void trace(mesh::TriangleSlot t);
  void emit(const Path& path);

  const terrain::Terrain& terrain_;
  const mesh::Mesh& mesh_;
  const std::vector<double> levels_;
  const std::optional<PlaceBox> box_;
  VoidMask voids_;

  std::vector<std::size_t>
      begins_;  // of each level's triangles, those with a higher lowest corner than the level before
  std::vector<std::uint32_t> triangles_;
  std::vector<std::uint32_t> active_;  // those that this level may cross
  std::vector<std::uint32_t> seen_;    // by triangle: one past the level that was traced through it last
  std::size_t level_index_ = 0;        // of the next level
  std::size_t at_ = 0;                 // in active_
  double level_ = 0;
  std::vector<ContourLine> ready_;  // parts of the line traced last, in reverse
};

}  // namespace tin::query
