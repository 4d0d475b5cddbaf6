// Local search for fewer vertices: ruin and recreate on a plateau. One or two neighbouring vertices are taken
// out, samples in the hole are made vertices until the tolerance holds again, and the change stays whenever
// the number of vertices has not grown: so the TIN wanders among states of equal size, and falls when it can.
// Most tries come to nothing, so they are made to cost little: for the last vertex of a try several places
// are looked at, and none is taken before it is known to do.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
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
  std::uint32_t below(std::uint32_t count) {
    return static_cast<std::uint32_t>((next() >> 32) * count >> 32);
  }
  double fraction() { return static_cast<double>(next() >> 11) * 0x1p-53; }

 private:
  std::uint64_t state_;
};

class Search {
 public:
  /// Requires: every sample over the patch's own triangles is within the tolerance. Borrows `patch`.
  Search(Patch& patch, double tolerance, Elevations elevations, std::uint64_t seed);

  /// Makes so many tries, or fewer when `stop` says so. Ensures: within the tolerance as before; not more
  /// vertices.
  void run(std::size_t tries, const std::function<bool()>& stop);

 private:
  /// A triangle with a sample over the tolerance.
  struct Bad {
    std::array<mesh::VertexSlot, 3> corners;  // counter-clockwise
    Site worst;
  };
  struct Change {
    enum class Kind { kInserted, kRemoved, kRaised } kind;
    mesh::VertexSlot vertex;  // unless removed
    Site site;                // if removed; with its height before, if raised
  };

  void attempt();
  void change_one(mesh::VertexSlot v);
  void change_two(mesh::VertexSlot v, mesh::VertexSlot other);
  mesh::VertexSlot some_neighbour(mesh::VertexSlot v);
  bool take_out(mesh::VertexSlot v);
  void look_into_hole();
  bool insert_first(std::span<const Site> removed);
  void find_spots(std::span<const Site> removed, std::uint32_t draws);
  bool insert_last();
  bool fits(Site& site);
  const Bad& some_bad() { return bad_[random_.below(static_cast<std::uint32_t>(bad_.size()))]; }
  std::uint32_t reach_over(const Bad& bad) const;
  Site some_spot(const Bad& bad, std::span<const Site> removed);
  bool concerns(const Bad& bad, exact::Point p) const;
  Heights heights_of(mesh::VertexSlot v) const;
  Heights heights_of_carved(const Site& site) const;
  std::optional<double> some_height(const Heights& heights);
  bool mend_by_height();
  bool try_height(mesh::VertexSlot v);
  bool a_witness_is_over(const Site& a, const Site& b, const Site& c) const;
  void look_at(const std::array<mesh::VertexSlot, 3>& corners);
  void remove_around();
  void roll_back();
  void settle_again();

  Patch& patch_;
  double tolerance_;
  double step_;        // heights that are fitted are whole multiples of it; 0: none is fitted
  std::int64_t cell_;  // its area, in lattice steps squared
  Random random_;
  std::vector<Bad> bad_;
  std::vector<Change> changes_;
  std::vector<Site> witnesses_;  // samples that were over the tolerance in this try
  std::vector<Site> spots_;      // where the last vertex may go
  std::vector<mesh::TriangleSlot> hole_;
  std::vector<mesh::HalfEdge> link_;
  std::vector<mesh::VertexSlot> neighbours_, unsettled_, changed_;
  Trial trial_;
  mesh::TriangleSlot near_{mesh::kNone};  // made by the last change
};

}  // namespace tin::simplify
