// Vertices and triangles in an order that depends on ids and the mesh only, for pages and exports: the same
// bytes from the same revision, also after a restart has stored everything elsewhere.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "tin/terrain/terrain.h"

namespace tin::query {

/// A finite triangle, counter-clockwise, the smallest id first.
struct TriangleView {
  std::array<terrain::VertexId, 3> ids;
  std::array<mesh::VertexSlot, 3> slots;
};

/// The triangles whose smallest vertex id is `vertex`, ordered by their second id. Requires: the vertex
/// exists.
void triangles_of(const terrain::Terrain& terrain, terrain::VertexId vertex, std::vector<TriangleView>& out);

/// Where a walk over all triangles stands: after `done` triangles of `vertex`.
struct TriangleCursor {
  std::uint64_t vertex = 0;
  std::uint32_t done = 0;
};

/// Walks all triangles, by smallest id, then second id.
class TriangleWalk {
 public:
  TriangleWalk(const terrain::Terrain& terrain, TriangleCursor from);
  /// The next triangle, nothing after the last.
  std::optional<TriangleView> next();
  /// Where to go on later. Also before the first next().
  TriangleCursor cursor() const;

 private:
  const terrain::Terrain& terrain_;
  std::optional<terrain::VertexId> vertex_;
  std::vector<TriangleView> batch_;
  std::size_t at_ = 0;
};

/// An edge between two finite vertices, the smaller id first.
struct EdgeView {
  std::array<terrain::VertexId, 2> ids;
  std::array<mesh::VertexSlot, 2> slots;
  bool hull = false;  // one of its sides is outside
};

/// The edges whose smaller vertex id is `vertex`, ordered by the other; also of vertices that stand in a line.
void edges_of(const terrain::Terrain& terrain, terrain::VertexId vertex, std::vector<EdgeView>& out);

/// How many edges there are, O(1): Euler's formula.
std::size_t edge_count(const terrain::Terrain& terrain);

/// Walks all edges, by smaller id, then the other.
class EdgeWalk {
 public:
  EdgeWalk(const terrain::Terrain& terrain, TriangleCursor from);
  /// The next edge, nothing after the last.
  std::optional<EdgeView> next();
  /// Where to go on later. Also before the first next().
  TriangleCursor cursor() const;

 private:
  const terrain::Terrain& terrain_;
  std::optional<terrain::VertexId> vertex_;
  std::vector<EdgeView> batch_;
  std::size_t at_ = 0;
};

}  // namespace tin::query
