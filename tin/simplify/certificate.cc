#include "tin/simplify/certificate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tin/base/check.h"
#include "tin/delaunay/walk.h"
#include "tin/simplify/facet.h"
#include "tin/simplify/tiles.h"

namespace tin::simplify {

using delaunay::Stop;
using mesh::TriangleSlot;
using mesh::VertexSlot;

namespace {

/// Samples that one thread measures at a time; the sums of squares are put together in this order.
constexpr SampleIndex kStretch = 1U << 16;
constexpr SampleIndex kTogether = 1U << 10;

struct Measured {
  std::size_t samples = 0, level = 0, on_vertices = 0;
  double worst_error = 0, squares = 0;
  SampleIndex worst = 0;
  bool within = true;
  std::array<std::size_t, kBins> histogram{};
};

class Certifier {
 public:
  Certifier(const Patch& result, double tolerance, double bin)
      : result_(result),
        tolerance_(tolerance),
        bin_(bin),
        at_(delaunay::finite_start(result.mesh(), result.mesh().triangle_at(mesh::kInfinite))),
        facet_(facet_over(at_)) {}

  Measured measure(SampleIndex begin, SampleIndex end) {
    Measured out;
    for (; begin < end; begin += std::min(end - begin, kTogether)) {
      sites_.clear();
      result_.samples().sites(begin, begin + std::min(end - begin, kTogether), sites_);
      for (const Site& site : sites_) look_up(site, out);
    }
    return out;
  }

 private:
  void look_up(const Site& sample, Measured& out) {
    ++out.samples;
    auto weights = facet_.weights(sample.at);
    if (!weights) {
      const Stop stop = delaunay::walk(result_.mesh(), sample.at, at_, delaunay::Everywhere{});
      TIN_CHECK(stop.kind == Stop::Kind::kInside);
      at_ = stop.triangle;
      facet_ = facet_over(at_);
      weights = facet_.weights(sample.at);
      TIN_CHECK(weights.has_value());
    }
    const bool is_level = result_.samples().is_level(sample.sample);
    if (is_level) ++out.level;
    const auto verdict = facet_.judge(*weights, sample.z, is_level ? 0 : tolerance_);
    if (is_corner(sample)) ++out.on_vertices;
    out.within = out.within && verdict.within;
    const double bins = bin_ > 0 ? verdict.error / bin_ : 0;
    ++out.histogram[bins < kBins ? static_cast<std::size_t>(bins) : kBins - 1];
    out.squares += verdict.error * verdict.error;
    if (verdict.error <= out.worst_error) return;
    out.worst_error = verdict.error;
    out.worst = sample.sample;
  }

  bool is_corner(const Site& sample) const {
    const auto& v = result_.mesh().triangle(at_).vertices;
    return std::any_of(v.begin(), v.end(), [&](VertexSlot corner) { return result_.site(corner).at == sample.at; });
  }

  Facet facet_over(TriangleSlot t) const {
    const auto& v = result_.mesh().triangle(t).vertices;
    const auto corner = [this](VertexSlot slot) {
      return Facet::Corner{result_.site(slot).at, result_.site(slot).z};
    };
    return {corner(v[0]), corner(v[1]), corner(v[2])};
  }

  const Patch& result_;
  double tolerance_, bin_;
  TriangleSlot at_;  // of the sample before: the next is often near
  Facet facet_;      // over it
  std::vector<Site> sites_;
};

void put_together(Certificate& sum, const Measured& part, double& squares, std::size_t& on_vertices) {
  sum.samples += part.samples;
  sum.level += part.level;
  on_vertices += part.on_vertices;
  squares += part.squares;
  sum.within = sum.within && part.within;
  for (std::size_t i = 0; i < kBins; ++i) sum.histogram[i] += part.histogram[i];
  if (part.worst_error <= sum.max_error) return;
  sum.max_error = part.worst_error;
  sum.worst = part.worst;
}

/// Those of the result's edges that are found from triangles begin..end-1, each once.
struct MeasuredEdges {
  std::size_t crossings = 0;
  EdgeScan worst;
  bool within = true;
};

MeasuredEdges measure_edges(const Patch& result, std::uint32_t begin, std::uint32_t end, double tolerance) {
  const mesh::Mesh& mesh = result.mesh();
  MeasuredEdges out;
  for (std::uint32_t slot = begin; slot < end; ++slot) {
    const TriangleSlot t(slot);
    if (!mesh.is_alive(t) || mesh.is_infinite(t)) continue;
    for (int i = 0; i < 3; ++i) {
      const TriangleSlot other = mesh.twin(t, i).triangle();
      if (other < t && !mesh.is_infinite(other)) continue;
      const EdgeScan found = result.samples().scan_edge(result.site(mesh.vertex(t, mesh::next3(i))),
                                                        result.site(mesh.vertex(t, mesh::prev3(i))), tolerance);
      out.crossings += found.crossings;
      out.within = out.within && !found.over;
      if (found.error > out.worst.error) out.worst = found;
    }
  }
  return out;
}

bool certify_edges(const Patch& result, double tolerance, unsigned threads, const Phase& phase, Certificate& sum) {
  const std::uint32_t end = result.mesh().triangle_slots();
  const std::size_t stretches = (std::size_t{end} + kTogether - 1) / kTogether;
  std::vector<MeasuredEdges> parts(stretches);
  const bool finished = for_each_tile(stretches, threads, phase, [&](std::size_t i) {
    const auto begin = static_cast<std::uint32_t>(i * kTogether);
    parts[i] = measure_edges(result, begin, begin + std::min(end - begin, kTogether), tolerance);
  });
  for (const MeasuredEdges& part : parts) {
    sum.crossings += part.crossings;
    sum.within = sum.within && part.within;
    if (part.worst.error <= sum.max_error) continue;
    sum.max_error = part.worst.error;
    sum.worst_edge = part.worst;
  }
  return finished;
}

}  // namespace

std::optional<Certificate> certify(const Patch& result, double tolerance, double bin, unsigned threads,
                                   const Phase& phase) {
  const SampleIndex end = result.samples().end();
  const std::size_t stretches = (std::size_t{end} + kStretch - 1) / kStretch;
  std::vector<Measured> parts(stretches);
  const bool has_surface = result.samples().has_surface();
  const bool finished = for_each_tile(stretches, threads, phase.part(0, has_surface ? 0.5 : 1), [&](std::size_t i) {
    const auto begin = static_cast<SampleIndex>(i * kStretch);
    parts[i] = Certifier(result, tolerance, bin).measure(begin, std::min(end - begin, kStretch) + begin);
  });
  if (!finished) return std::nullopt;
  Certificate out;
  double squares = 0;
  std::size_t on_vertices = 0;
  for (const Measured& part : parts) put_together(out, part, squares, on_vertices);
  TIN_CHECK(on_vertices == result.mesh().vertex_count());
  out.rmse = std::sqrt(squares / static_cast<double>(out.samples));
  if (has_surface && !certify_edges(result, tolerance, threads, phase.part(0.5, 1), out)) return std::nullopt;
  return out;
}

}  // namespace tin::simplify
