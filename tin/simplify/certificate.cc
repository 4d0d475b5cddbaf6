#include "tin/simplify/certificate.h"

#include <cmath>

#include "tin/base/check.h"
#include "tin/simplify/facet.h"

namespace tin::simplify {

using delaunay::Location;
using mesh::TriangleSlot;
using mesh::VertexSlot;
using terrain::Terrain;

namespace {

class Certifier {
 public:
  Certifier(const Terrain& source, const WorkingTin& result, double tolerance)
      : source_(source),
        result_(result),
        tolerance_(tolerance),
        is_removed_(source.mesh().vertex_slots(), false),
        at_(result.mesh().triangle_at(mesh::kInfinite)),
        facet_(facet_over(at_)) {}

  void look_up(VertexSlot sample) {
    const exact::Point p = source_.mesh().point(sample);
    const Location where = result_.triangulation().locate_from(p, at_);
    TIN_CHECK(where.kind != Location::Kind::kOutsideHull);
    if (where.triangle != at_) facet_ = facet_over(where.triangle);
    at_ = where.triangle;
    if (where.kind == Location::Kind::kOnVertex) {
      TIN_CHECK(result_.site(where.vertex).z == source_.z(sample));
      ++kept_;
      return;
    }
    is_removed_[sample.value()] = true;
    const auto weights = facet_.weights(p);
    TIN_CHECK(weights.has_value());
    const auto verdict = facet_.judge(*weights, source_.z(sample), tolerance_);
    within_ = within_ && verdict.within;
    squares_ += verdict.error * verdict.error;
    if (verdict.error < worst_error_ || verdict.error == 0) return;
    if (verdict.error == worst_error_ && !(p < source_.mesh().point(worst_))) return;
    worst_error_ = verdict.error;
    worst_ = sample;
  }

  Certificate result(std::size_t samples) const {
    TIN_CHECK(kept_ == result_.vertex_count());
    Certificate out;
    out.max_error = worst_error_;
    if (worst_error_ > 0)
      out.worst = Worst{source_.id_of(worst_), source_.mesh().point(worst_), worst_error_};
    out.rmse = std::sqrt(squares_ / static_cast<double>(samples));
    out.within = within_;
    out.removed.reserve(samples - kept_);
    const terrain::IdMap& ids = source_.ids();
    for (auto id = ids.first_from(terrain::VertexId(0)); id;
         id = ids.first_from(terrain::VertexId(id->value() + 1))) {
      if (is_removed_[ids.slot_of(*id)->value()]) out.removed.push_back(*id);
    }
    return out;
  }

 private:
  /// For an infinite triangle: over the finite one behind its hull edge.
  Facet facet_over(TriangleSlot t) const {
    const mesh::Mesh& mesh = result_.mesh();
    const TriangleSlot finite =
        mesh.is_infinite(t) ? mesh.twin(t, mesh.index_of(t, mesh::kInfinite)).triangle() : t;
    const auto& v = mesh.triangle(finite).vertices;
    const auto corner = [this](VertexSlot slot) {
      return Facet::Corner{result_.site(slot).at, result_.site(slot).z};
    };
    return {corner(v[0]), corner(v[1]), corner(v[2])};
  }

  const Terrain& source_;
  const WorkingTin& result_;
  double tolerance_;
  std::vector<bool> is_removed_;  // by slot of the source
  TriangleSlot at_;               // of the sample before: the next is often near
  Facet facet_;                   // over it
  std::size_t kept_ = 0;
  double worst_error_ = 0, squares_ = 0;
  VertexSlot worst_{mesh::kNone};
  bool within_ = true;
};

}  // namespace

std::optional<Certificate> certify(const Terrain& source, const WorkingTin& result, double tolerance,
                                   const Phase& phase) {
  Certifier certifier(source, result, tolerance);
  const std::uint32_t slots = source.mesh().vertex_slots();
  for (std::uint32_t i = 1; i < slots; ++i) {
    if (i % 4096 == 0) {
      if (phase.cancelled()) return std::nullopt;
      phase.report(static_cast<double>(i) / slots);
    }
    if (source.mesh().is_alive(VertexSlot(i))) certifier.look_up(VertexSlot(i));
  }
  if (phase.cancelled()) return std::nullopt;
  return certifier.result(source.vertex_count());
}

}  // namespace tin::simplify
