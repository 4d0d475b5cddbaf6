#include "tin/terrain/vertex_set.h"

#include <algorithm>

namespace tin::terrain {

std::optional<Placement> VertexSet::find(VertexId id) const {
  if (const auto changed = changed_.find(id.value()); changed != changed_.end()) return changed->second;
  const auto at = std::lower_bound(base_.begin(), base_.end(), id,
                                   [](const Vertex& vertex, VertexId wanted) { return vertex.id < wanted; });
  if (at == base_.end() || at->id != id) return std::nullopt;
  return Placement{at->at, at->z};
}

base::Result<void> VertexSet::replay(const Change& change) {
  for (std::size_t i = 0; i < change.steps.size(); ++i) {
    const Step& step = change.steps[i];
    if (find(step.id) != step.before) {
      return base::error(base::Code::kConflict, "The change does not fit the terrain's vertices.",
                         "/" + std::to_string(i));
    }
    changed_[step.id.value()] = step.after;
    if (step.id >= next_id_) next_id_ = VertexId(step.id.value() + 1);
  }
  return {};
}

std::vector<Vertex> VertexSet::vertices() const {
  std::vector<Vertex> put;
  for (const auto& [id, placement] : changed_) {
    if (placement) put.push_back({VertexId(id), placement->at, placement->z});
  }
  const auto by_id = [](const Vertex& a, const Vertex& b) { return a.id < b.id; };
  std::sort(put.begin(), put.end(), by_id);
  std::vector<Vertex> out;
  out.reserve(base_.size() + put.size());
  auto next = put.begin();
  for (const Vertex& vertex : base_) {
    while (next != put.end() && next->id < vertex.id) out.push_back(*next++);
    if (!changed_.contains(vertex.id.value())) out.push_back(vertex);
  }
  out.insert(out.end(), next, put.end());
  return out;
}

std::string digest_of(std::span<const Vertex> vertices, const frame::Frame& frame) {
  VertexSetHash hash;
  for (const Vertex& vertex : vertices) hash.add(vertex.at, vertex.z);
  return hash.digest(frame);
}

}  // namespace tin::terrain
