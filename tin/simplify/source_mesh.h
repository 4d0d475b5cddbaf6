// The triangulation of all samples: the surface that they make, and who is whose neighbour.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "tin/base/progress.h"
#include "tin/mesh/mesh.h"
#include "tin/simplify/facet.h"
#include "tin/simplify/samples.h"

namespace tin::simplify {

/// Canonical, as every TIN is; over voids, too. About 80 bytes per sample.
class SourceMesh {
 public:
  /// While it is made.
  static constexpr std::size_t kBytesPerSample = 144;

  /// Null when `progress`, which may be null and is not reported to, was cancelled. Requires: at least three
  /// samples that are not collinear.
  static std::shared_ptr<const SourceMesh> of(const Samples& samples, unsigned threads,
                                              const base::Progress* progress);

  const mesh::Mesh& mesh() const { return mesh_; }
  SampleIndex sample(mesh::VertexSlot v) const { return samples_of_[v.value()]; }
  mesh::VertexSlot slot(SampleIndex sample) const { return mesh::VertexSlot(slots_[sample]); }
  double z(mesh::VertexSlot v) const { return z_[v.value()]; }

  /// Where an edge of the surface, from p on the right to q on the left, crosses the segment.
  struct Crossing {
    mesh::VertexSlot p, q;
    std::int64_t to_p, to_q;  // the crossing is to_p / (to_p + to_q) of the way from p to q; both > 0
    std::int64_t from_a;      // and from_a / (to_p + to_q) of the way from a to b; > 0
    std::int64_t whole() const { return to_p + to_q; }
  };
  /// Calls visit(crossing) for each edge that crosses the segment between two samples strictly inside both,
  /// in order, until it returns false. Requires: both stand at vertices.
  template <class Visit>
  void visit_crossings(const Site& a, const Site& b, const Visit& visit) const;

  /// How far the segment, with its ends at the heights of a and b, is from the surface at a crossing.
  Verdict judge(const Crossing& at, const Site& a, const Site& b, double tolerance) const {
    const double zp = z(at.p), zq = z(at.q);
    return judge_sum({{{at.from_a, b.z, a.z}, {at.to_q, a.z, zp}, {at.to_p, a.z, zq}}}, at.whole(),
                     tolerance);
  }
  /// The height of the surface there, rounded.
  double height(const Crossing& at) const {
    return z(at.p) + (z(at.q) - z(at.p)) * (static_cast<double>(at.to_p) / static_cast<double>(at.whole()));
  }

 private:
  /// How a segment goes on from a vertex on it: along an edge to the next vertex, or over the edge opposite.
  struct Exit {
    std::optional<mesh::VertexSlot> next;
    mesh::HalfEdge over;  // seen from beyond
  };
  SourceMesh() = default;
  bool build(const Samples& samples, unsigned threads, const base::Progress* progress);
  Exit leave(mesh::VertexSlot from, exact::Point a, exact::Point b) const;

  mesh::Mesh mesh_;
  std::vector<double> z_;                // by vertex slot
  std::vector<SampleIndex> samples_of_;  // the same
  std::vector<std::uint32_t> slots_;     // by sample
};

template <class Visit>
void SourceMesh::visit_crossings(const Site& a, const Site& b, const Visit& visit) const {
  using mesh::next3;
  const auto side = [&](mesh::VertexSlot v) { return exact::orientation(a.at, b.at, mesh_.point(v)); };
  const mesh::VertexSlot end = slot(b.sample);
  for (mesh::VertexSlot at = slot(a.sample); at != end;) {
    const Exit exit = leave(at, a.at, b.at);
    if (exit.next) {
      at = *exit.next;
      continue;
    }
    mesh::HalfEdge beyond = exit.over;  // runs from q to p
    Crossing crossing{mesh_.destination(beyond), mesh_.origin(beyond), 0, 0, 0};
    crossing.to_p = -side(crossing.p);
    crossing.to_q = side(crossing.q);
    for (;;) {
      crossing.from_a = exact::orientation(mesh_.point(crossing.p), mesh_.point(crossing.q), a.at);
      if (!visit(crossing)) return;
      const mesh::VertexSlot r = mesh_.apex(beyond);
      const std::int64_t of_r = side(r);
      if (of_r == 0) {
        at = r;
        break;
      }
      if (of_r > 0) {
        crossing.q = r;
        crossing.to_q = of_r;
        beyond = mesh_.twin(beyond.triangle(), next3(beyond.index()));
      } else {
        crossing.p = r;
        crossing.to_p = -of_r;
        beyond = mesh_.twin(beyond.triangle(), mesh::prev3(beyond.index()));
      }
    }
  }
}

}  // namespace tin::simplify
