// Local search for fewer vertices: ruin and recreate on a plateau. One or two neighbouring vertices are taken out, samples in
// the hole are made vertices until the tolerance holds again, and the change stays whenever the number of vertices has not
// grown: so the TIN wanders among states of equal size, and falls when it can.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "tin/simplify/facet.h"
#include "tin/simplify/patch.h"
#include "tin/simplify/simplify.h"
#include "tin/simplify/trial.h"

namespace tin::simplify {

/// A small generator whose stream is the same everywhere (SplitMix64: Steele et al. 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    std::uint64_t x = state_ += 0x9e3779b97f4a7c15U;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31);
  }
  /// 0 .. count - 1, as good as evenly. Requires: 0 < count.
  std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>((next() >> 32) * count >> 32); }
  double fraction() { return static_cast<double>(next() >> 11) * 0x1p-53; }

 private:
  std::uint64_t state_;
};

class Search {
 public:
  /// Requires: every sample over the patch's own triangles is within the tolerance. Borrows `patch`.
  Search(Patch& patch, double tolerance, Elevations elevations, std::uint64_t seed);

  /// Makes so many tries, or fewer when `stop` says so. Ensures: within the tolerance as before; not more vertices.
  void run(std::size_t tries, const std::function<bool()>& stop);

 private:
  /// A triangle with a sample over the tolerance.
  struct Bad {
    mesh::TriangleSlot triangle;
    std::uint32_t stamp;
    SampleIndex sample;
  };
  struct Change {
    enum class Kind { kInserted, kRemoved, kRaised } kind;
    mesh::VertexSlot vertex;  // unless removed
    Site site;                // if removed; with its height before, if raised
  };

  void attempt();
  mesh::VertexSlot some_neighbour(mesh::VertexSlot v);
  bool take_out(mesh::VertexSlot v);
  void look_into_hole();
  bool recreate(std::size_t removed);
  bool is_mended();
  bool look_at_fresh();
  bool put_in(const Bad& bad, bool is_last);
  Heights heights_of(mesh::VertexSlot v) const;
  std::optional<double> some_height(const Heights& heights);
  bool mend_by_height();
  bool try_height(mesh::VertexSlot v);
  bool a_witness_is_over() const;
  void grow_stamps();
  bool look_at(mesh::TriangleSlot t, Depth depth);
  void remove_around();
  void roll_back();

  Patch& patch_;
  double tolerance_;
  double step_;  // heights that are fitted are whole multiples of it; 0: none is fitted
  Random random_;
  std::vector<std::uint32_t> stamps_;  // of each triangle: what was said of it before is void
  std::vector<Bad> bad_;
  std::vector<Change> changes_;
  std::vector<Site> witnesses_;  // samples that were over the tolerance in this try
  std::vector<mesh::TriangleSlot> hole_;
  std::vector<mesh::HalfEdge> link_;
  std::vector<mesh::VertexSlot> neighbours_;
  Trial trial_;
  mesh::TriangleSlot near_{mesh::kNone};  // made by the last change
};

}  // namespace tin::simplify
