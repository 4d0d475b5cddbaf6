// A terrain: the canonical Delaunay mesh of a set of vertices, with elevations, stable ids and a frame.
//
//   auto terrain = Terrain::build(frame, placements, Duplicates::kReplace);
//   auto applied = terrain->apply({{Insert{p, 12.5}}, {Remove{VertexId(7)}}}, Duplicates::kReject);
//   journal(applied->change);            // durable first, then answer
//   terrain->replay(applied->change.inverse());  // undo: digest as before
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tin/base/progress.h"
#include "tin/base/result.h"
#include "tin/delaunay/triangulation.h"
#include "tin/frame/frame.h"
#include "tin/terrain/amendments.h"
#include "tin/terrain/digest.h"
#include "tin/terrain/edit.h"
#include "tin/terrain/id_map.h"
#include "tin/terrain/source_grid.h"

namespace tin::terrain {

/// A vertex as readers see it.
struct Vertex {
  VertexId id;
  exact::Point at;
  double z = 0;
};

struct ZRange {
  double min = 0, max = 0;
};

struct Box {
  exact::Point min, max;
};

class Terrain {
 public:
  /// What apply() did: one id per edit (of the vertex inserted, found, removed, moved or set) and the change.
  struct Applied {
    std::vector<VertexId> ids;
    Change change;
    VertexId next_id_before{1};
  };

  explicit Terrain(frame::Frame frame) : frame_(std::move(frame)) {}

  /// Builds the terrain of `placements`; ids 1.. are given in their order (duplicates by the policy; the
  /// first keeps its id). Requires: positions on the lattice.
  /// Errors: kNotFinite, kInvalidValue (elevation beyond kMaxElevation), kOutsideLattice, kDuplicatePosition
  /// (policy kReject), kCancelled; `where` is "/i".
  /// Threads: uses up to `threads`; the terrain is the same for any number.
  static base::Result<Terrain> build(frame::Frame frame, std::span<const Placement> placements,
                                     Duplicates duplicates, base::Progress* progress = nullptr,
                                     unsigned threads = 1);
  /// The same with given ids (a checkpoint's): ids must be distinct and positions too, else kMalformed.
  static base::Result<Terrain> restore(frame::Frame frame, std::span<const Vertex> vertices,
                                       VertexId next_id, unsigned threads = 1);

  /// Applies all edits or none, in order; a later edit may name a vertex that an earlier one inserted.
  /// Errors: kUnknownVertex, kDuplicatePosition, kNotFinite, kInvalidValue, kOutsideLattice; `where` is "/i"
  /// (the edit's index). Ensures: on error the terrain is as it was. Cost: expected O(log n) per edit; where
  /// removals have left more gaps than vertices the arrays are made compact, O(n), less than the removals cost.
  base::Result<Applied> apply(std::span<const Edit> edits, Duplicates duplicates);

  /// Takes back the last apply() as if it had never been: ids that it gave are given again. Requires: nothing
  /// was applied or replayed since.
  void undo(const Applied& applied);

  /// Repeats a recorded change (journal) or an inverse (undo), with the ids it names.
  /// Errors: kConflict when it does not fit the present set; then nothing is changed.
  base::Result<void> replay(const Change& change);

  const frame::Frame& frame() const { return frame_; }
  const delaunay::Triangulation& triangulation() const { return triangulation_; }
  const mesh::Mesh& mesh() const { return triangulation_.mesh(); }

  std::size_t vertex_count() const { return ids_.size(); }
  std::size_t triangle_count() const { return mesh().finite_triangle_count(); }
  std::optional<Vertex> vertex(VertexId id) const;
  std::optional<mesh::VertexSlot> slot_of(VertexId id) const { return ids_.slot_of(id); }
  VertexId id_of(mesh::VertexSlot slot) const { return ids_.id_of(slot); }
  double z(mesh::VertexSlot slot) const { return z_[slot.value()]; }
  const IdMap& ids() const { return ids_; }
  /// The id that the next insertion will get.
  VertexId next_id() const { return next_id_; }

  /// The vertices by ascending id, but for those in `without` (ascending).
  std::vector<Vertex> vertices_by_id(std::span<const VertexId> without = {}) const;
  /// What is left when the vertices of these ids (ascending) are removed, built anew: the same terrain as by
  /// removing them one by one, sooner when they are many.
  Terrain without(std::span<const VertexId> ids, unsigned threads = 1) const { return replaced(ids, {}, threads); }
  /// The same with other vertices in their stead, whose ids, from next_id() on, ascend. Requires: no two at one position.
  Terrain replaced(std::span<const VertexId> removed, std::span<const Vertex> added, unsigned threads = 1) const;

  std::string digest() const { return hash_.digest(frame_); }
  /// O(n) each; empty terrain: nothing.
  std::optional<Box> bounds() const;
  std::optional<ZRange> z_range() const;

  void set_source_grid(std::shared_ptr<const SourceGrid> grid) { source_grid_ = std::move(grid); }
  const SourceGrid* source_grid() const { return source_grid_.get(); }
  std::shared_ptr<const SourceGrid> shared_source_grid() const { return source_grid_; }

  /// What became of the samples that the terrain was made of.
  const Amendments& amendments() const { return amendments_; }
  void set_amendments(Amendments amendments) { amendments_ = std::move(amendments); }
  /// Has the samples follow a change that was applied or replayed, once it is certain to stay. Requires: it was the last.
  void amend(const Change& change) { amendments_.take(*this, change); }

 private:
  base::Result<VertexId> apply_one(const Insert& edit, Duplicates duplicates, Change& change);
  base::Result<VertexId> apply_one(const Remove& edit, Duplicates duplicates, Change& change);
  base::Result<VertexId> apply_one(const Move& edit, Duplicates duplicates, Change& change);
  base::Result<VertexId> apply_one(const SetZ& edit, Duplicates duplicates, Change& change);
  bool take(const Step& step);  // performs one step if it fits
  void put(mesh::VertexSlot slot, VertexId id, const Placement& placement);
  void drop(mesh::VertexSlot slot, VertexId id);
  void close_gaps();

  frame::Frame frame_;
  delaunay::Triangulation triangulation_;
  std::vector<double> z_;  // by vertex slot, in the frame's vertical unit
  IdMap ids_;
  VertexId next_id_{1};
  VertexSetHash hash_;
  std::shared_ptr<const SourceGrid> source_grid_;
  Amendments amendments_;
};

}  // namespace tin::terrain
