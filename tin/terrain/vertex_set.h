// A terrain's vertices without their mesh: what a list of changes makes of them, in linear time. A checkpoint
// is brought forward so, and a large undo prepared, without the terrain that is being served.
//
//   VertexSet set(checkpoint.vertices, checkpoint.next_id);
//   for (const Change& change : journal) set.replay(change);
//   auto terrain = Terrain::restore(frame, set.vertices(), set.next_id());
#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "tin/base/result.h"
#include "tin/frame/frame.h"
#include "tin/terrain/edit.h"
#include "tin/terrain/terrain.h"

namespace tin::terrain {

class VertexSet {
 public:
  /// Requires: `by_id` ascends.
  VertexSet(std::vector<Vertex> by_id, VertexId next_id) : base_(std::move(by_id)), next_id_(next_id) {}

  /// Errors: kConflict when a step does not fit the set; `where` is "/i". The set is of no use then. Whether
  /// two vertices come to stand at one position is not asked here. Cost: O(log n) per step.
  base::Result<void> replay(const Change& change);

  /// By ascending id. Cost: O(n).
  std::vector<Vertex> vertices() const;
  VertexId next_id() const { return next_id_; }

 private:
  std::optional<Placement> find(VertexId id) const;

  std::vector<Vertex> base_;
  std::unordered_map<std::uint64_t, std::optional<Placement>> changed_;  // by id; nothing: removed
  VertexId next_id_;
};

/// The digest that a terrain of these vertices has.
std::string digest_of(std::span<const Vertex> vertices, const frame::Frame& frame);

}  // namespace tin::terrain
