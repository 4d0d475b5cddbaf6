// A terrain, or the part of it in a box, as a mesh to be written in any format.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "proto/bbox.h"
#include "proto/formats/mesh.h"
#include "tin/query/order.h"
#include "tin/terrain/terrain.h"

namespace proto::formats {

/// What of a terrain becomes a mesh, and in which coordinates.
struct MeshRequest {
  /// Converts x and y in place; ok[i] becomes 0 where there is no counterpart. Returns whether all have.
  using Convert =
      std::function<bool(std::span<double> x, std::span<double> y, std::vector<std::uint8_t>& ok)>;

  std::string title{};
  Convert convert{};        // none: the terrain's own coordinates
  std::string crs{};        // that `convert` leads to; without it the terrain's is taken
  bool geographic = false;  // of the coordinates
  double unit_m = 1;        // of the coordinates, if they are no degrees
  /// Only triangles that touch it, their vertices, and vertices inside; in the mesh's coordinates.
  std::optional<Bbox> box{};
  Voids voids = Voids::kKeep;  // kFill: no triangle is hidden
  /// Asked now and then while the mesh is prepared; an error ends it.
  std::function<tin::base::Result<void>()> check{};
};

/// Vertices by ascending id and triangles in the order of TriangleWalk: the same for the same revision,
/// always. Borrows the terrain, which must not change. Memory: 4 bytes per vertex, and a quarter of a byte
/// per triangle where there is a box or a void. One thread.
class TerrainMesh : public MeshSource {
 public:
  /// Cost: a pass over the vertices; with a box or voids also over the triangles.
  /// Errors: kInvalidValue when there is no vertex, or one cannot be converted; those of request.check().
  static tin::base::Result<std::unique_ptr<TerrainMesh>> create(const tin::terrain::Terrain& terrain,
                                                                MeshRequest request);

  const MeshHead& head() const override { return head_; }
  void rewind() override;
  bool next_vertex(MeshVertex& vertex) override;
  bool next_triangle(MeshTriangle& triangle) override;

 private:
  TerrainMesh(const tin::terrain::Terrain& terrain, MeshRequest request);
  tin::base::Result<void> prepare();
  tin::base::Result<void> choose_triangles();
  tin::base::Result<void> choose_vertices();
  void take(std::span<const tin::query::TriangleView> triangles);
  Position own(tin::mesh::VertexSlot slot) const;
  bool convert(std::vector<Position>& positions);
  bool refill();
  bool is_kept(std::size_t triangle) const { return kept_.empty() || kept_[2 * triangle]; }
  bool is_hidden(std::size_t triangle) const { return !kept_.empty() && kept_[2 * triangle + 1]; }

  const tin::terrain::Terrain& terrain_;
  const MeshRequest request_;
  MeshHead head_;
  std::vector<std::uint32_t> number_;  // by slot; kAbsent for vertices that are left out
  std::vector<bool> kept_;             // two bits per triangle in order: kept, hidden; empty: all, none

  std::optional<VertexId> next_;
  std::vector<MeshVertex> chunk_;
  std::size_t at_ = 0;
  std::optional<tin::query::TriangleWalk> walk_;
  std::size_t walked_ = 0;
  std::vector<double> x_, y_;
  std::vector<std::uint8_t> ok_;
};

}  // namespace proto::formats
