#include "tin/simplify/simplify.h"

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "tin/exact/predicates.h"
#include "tin/simplify/certificate.h"
#include "tin/simplify/decimate.h"
#include "tin/simplify/greedy.h"
#include "tin/simplify/phase.h"
#include "tin/simplify/samples.h"
#include "tin/simplify/working_tin.h"

namespace tin::simplify {

using base::Code;
using base::error;
using base::Result;
using exact::Point;
using mesh::VertexSlot;
using terrain::Terrain;

namespace {

/// First to a looser tolerance, then to the one asked for: the deletions between leave better places for the
/// rest.
constexpr double kLooser = 1.15;
/// When the tolerance takes so many times the budget, deletions cannot make up for it.
constexpr std::size_t kHopeless = 2;
constexpr int kBudgetRounds = 8;
constexpr double kWorthAnotherRound = 0.995;  // of the error before it

Result<void> check(const Options& options) {
  if (!options.tolerance && !options.max_vertices) {
    return error(Code::kInvalidValue, "Either a tolerance or a number of vertices is needed.");
  }
  if (options.tolerance && !(std::isfinite(*options.tolerance) && *options.tolerance >= 0)) {
    return error(Code::kInvalidValue, "The tolerance must be a finite number and not negative.");
  }
  return {};
}

Result<void> check_budget(const Options& options, std::size_t needed) {
  if (!options.max_vertices || *options.max_vertices >= needed) return {};
  return error(Code::kInvalidValue, "This terrain needs at least " + std::to_string(needed) + " vertices.");
}

/// The corners of the convex hull, in its order. Requires: dimension 2.
std::vector<Point> hull_corners(const mesh::Mesh& mesh) {
  std::vector<mesh::HalfEdge> link;
  mesh.link(mesh::kInfinite, link);
  std::vector<Point> hull, corners;
  for (const mesh::HalfEdge e : link) hull.push_back(mesh.point(mesh.origin(e)));
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Point before = hull[i == 0 ? hull.size() - 1 : i - 1],
                after = hull[i + 1 == hull.size() ? 0 : i + 1];
    if (exact::orientation(before, hull[i], after) != 0) corners.push_back(hull[i]);
  }
  return corners;
}

enum class End { kDone, kOverBudget, kCancelled };

/// Brings every sample within the tolerance; gives up when that seems to need more vertices than `budget`.
End reduce_to_tolerance(WorkingTin& tin, double tolerance, std::size_t budget, const Phase& phase) {
  const std::size_t hopeless =
      budget > Greedy::kNoBudget / kHopeless ? Greedy::kNoBudget : kHopeless * budget;
  double from = 0;
  for (const double factor : {kLooser, 1.0}) {
    if (factor != 1.0 && tolerance == 0) continue;
    const double target = std::min(tolerance * factor, std::numeric_limits<double>::max());
    const double to = factor == 1.0 ? 1.0 : 0.65;
    switch (Greedy(tin, target).run(hopeless, phase.part(from, (from + to) / 2))) {
      case Greedy::End::kCancelled:
        return End::kCancelled;
      case Greedy::End::kBudgetSpent:
        return End::kOverBudget;
      case Greedy::End::kTargetMet:
        break;
    }
    if (!Decimation(tin, target).run(phase.part((from + to) / 2, to))) return End::kCancelled;
    from = to;
  }
  return tin.vertex_count() <= budget ? End::kDone : End::kOverBudget;
}

/// Makes the largest error small with at most `budget` vertices: spends it, takes back what the error reached
/// does not need, spends that again. False when cancelled.
bool reduce_to_budget(WorkingTin& tin, std::size_t budget, const Phase& phase) {
  double before = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kBudgetRounds; ++round) {
    // Later rounds are shorter, and often there are none.
    const Phase part = phase.part(1 - std::ldexp(1.0, -round), 1 - std::ldexp(1.0, -round - 1));
    Greedy greedy(tin, 0);
    const auto end = greedy.run(budget, part.part(0, 0.5));
    if (end == Greedy::End::kCancelled) return false;
    const double reached = end == Greedy::End::kTargetMet ? 0 : greedy.return_to_best();
    // The error was rounded; a little above it the worst sample's own star is not held up.
    const double tolerance = reached == 0 ? 0 : reached * (1 + 0x1p-40);
    if (!Decimation(tin, tolerance).run(part.part(0.5, 1))) return false;
    if (reached == 0 || reached > before * kWorthAnotherRound) return true;
    before = reached;
  }
  return true;
}

Outcome nothing_removed(const Terrain& source) {
  Outcome out;
  out.report.vertices_before = out.report.vertices_after = source.vertex_count();
  return out;
}

Result<Outcome> certified(const Terrain& source, const WorkingTin& tin, const Options& options,
                          bool to_tolerance, const Phase& phase) {
  const double asked = options.tolerance.value_or(std::numeric_limits<double>::max());
  auto certificate = certify(source, tin, asked, phase);
  if (!certificate) return error(Code::kCancelled, "Cancelled.");
  TIN_CHECK(certificate->within || !to_tolerance);
  Outcome out;
  out.removed = std::move(certificate->removed);
  out.report = {source.vertex_count(), tin.vertex_count(), certificate->max_error,
                certificate->worst,    certificate->rmse,  certificate->within};
  phase.report(1);
  return out;
}

}  // namespace

Result<Outcome> simplify(const Terrain& source, const Options& options, base::Progress* progress) {
  if (auto fine = check(options); !fine) return fine.error();
  const bool is_line = source.mesh().dimension() < 2;
  const auto corners = is_line ? std::vector<Point>() : hull_corners(source.mesh());
  const std::size_t needed = is_line ? source.vertex_count() : corners.size();
  if (auto fine = check_budget(options, needed); !fine) return fine.error();
  if (is_line) return nothing_removed(source);

  const Phase whole(progress, 0, 1), reducing = whole.part(0.05, 0.9);
  const auto samples = make_samples(source, progress);
  if (!samples) return error(Code::kCancelled, "Cancelled.");
  std::vector<SampleIndex> corner_samples;
  for (const Point p : corners) corner_samples.push_back(samples->find(p));
  WorkingTin tin(*samples, corner_samples);
  const std::size_t budget = options.max_vertices.value_or(Greedy::kNoBudget);
  bool to_tolerance = false;
  if (options.tolerance) {
    const End end = reduce_to_tolerance(tin, *options.tolerance, budget,
                                        reducing.part(0, options.max_vertices ? 0.4 : 1));
    if (end == End::kCancelled) return error(Code::kCancelled, "Cancelled.");
    to_tolerance = end == End::kDone;
  }
  if (!to_tolerance) {
    if (options.tolerance) tin = WorkingTin(*samples, corner_samples);
    const Phase rest = reducing.part(options.tolerance ? 0.4 : 0, 1);
    if (!reduce_to_budget(tin, budget, rest)) return error(Code::kCancelled, "Cancelled.");
  }
  return certified(source, tin, options, to_tolerance, whole.part(0.9, 1));
}

}  // namespace tin::simplify
