#include "tin/simplify/reduce.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "tin/simplify/decimate.h"
#include "tin/simplify/fast.h"
#include "tin/simplify/greedy.h"
#include "tin/simplify/search.h"
#include "tin/simplify/tiles.h"

namespace tin::simplify {

namespace {

constexpr std::size_t kFewVertices = 1024;  // are not worth being divided
constexpr int kBudgetRounds = 8;
constexpr double kWorthAnotherRound = 0.995;  // of the error before it
/// On terrain the number of vertices grows about as error^-1.3.
constexpr double kGrowth = 1.3;
/// When a tolerance takes so many times the budget, local search cannot make up for it.
constexpr std::size_t kHopeless = 3;

/// Rounds of local search; in each the ground is divided elsewhere.
int rounds_of(Effort effort) {
  switch (effort) {
    case Effort::kFast:
      return 0;
    case Effort::kBalanced:
      return 2;
    case Effort::kThorough:
      return 9;
    case Effort::kBest:
      return 50;
  }
  return 0;
}

class Reduction {
 public:
  Reduction(const Samples& samples, std::span<const SampleIndex> corners, const Options& options)
      : samples_(samples),
        corners_(corners),
        options_(options),
        random_(options.seed),
        rounds_(rounds_of(options.effort)) {
    // It is the search that fits, and there is more to find.
    if (options.elevations == Elevations::kFit) rounds_ = std::max(2 * rounds_, 1);
  }

  std::optional<Reduced> run(const Phase& phase) {
    const std::size_t budget = options_.max_vertices.value_or(Greedy::kNoBudget);
    if (options_.tolerance) {
      auto tin = to_tolerance(*options_.tolerance, budget, phase.part(0, options_.max_vertices ? 0.4 : 1));
      if (!tin) return std::nullopt;
      if (tin->mesh().vertex_count() <= budget) return Reduced{std::move(tin), true, *options_.tolerance};
    }
    return to_budget(budget, phase.part(options_.tolerance ? 0.4 : 0, 1));
  }

 private:
  bool out_of_time() const { return options_.out_of_time && options_.out_of_time(); }

  std::unique_ptr<Patch> to_tolerance(double tolerance, std::size_t budget, const Phase& phase) {
    const double share = 1.0 / (1 + rounds_);  // about; of the time
    auto tin = reach_tolerance(samples_, corners_, tolerance, options_.threads, phase.part(0, share));
    if (!tin || rounds_ == 0 || tin->mesh().vertex_count() / kHopeless > budget) return tin;
    for (int round = 0; round < rounds_ && !out_of_time(); ++round) {
      const double from = share + (1 - share) * round / rounds_,
                   to = share + (1 - share) * (round + 1) / rounds_;
      if (!search(tin, tolerance, phase.part(from, to))) return nullptr;
    }
    return Decimation(*tin, tolerance).run(phase.part(1, 1)) ? std::move(tin) : nullptr;
  }

  /// One round. False when cancelled; then `tin` is null.
  bool search(std::unique_ptr<Patch>& tin, double tolerance, const Phase& phase) {
    constexpr double kTriesPerVertex = 1.3;
    const std::size_t vertices = tin->mesh().vertex_count();
    const double x = random_.fraction(), y = random_.fraction();
    const auto tiling = vertices < kFewVertices
                            ? Tiling(samples_.extent(), 1, 1)
                            : Tiling::of_about(samples_.extent(), patch_count(vertices), x, y);
    const std::uint64_t seed = random_.next();
    return work_in_patches(tin, tiling, options_.threads, phase, [&](Patch& patch, std::size_t tile) {
      const auto stop = [&] { return phase.cancelled() || out_of_time(); };
      Search(patch, tolerance, options_.elevations, Random(seed + tile).next())
          .run(static_cast<std::size_t>(kTriesPerVertex * static_cast<double>(patch.owned_count())), stop);
    });
  }

  std::optional<Reduced> to_budget(std::size_t budget, const Phase& phase) {
    const double share = rounds_ == 0 ? 1 : 0.2;
    std::vector<Pin> pins;
    for (const SampleIndex corner : corners_) pins.push_back({samples_.site(corner).z, corner, true});
    auto tin = std::make_unique<Patch>(samples_, std::span<const Pin>(), pins);
    const auto error = spend(*tin, budget, phase.part(0, share));
    if (!error) return std::nullopt;
    if (*error == 0 || rounds_ == 0) return Reduced{std::move(tin), false, *error};
    return tighten(std::move(tin), *error, budget, phase.part(share, 1));
  }

  /// Makes the largest error small with at most `budget` vertices: spends it, takes back what the error
  /// reached does not need, spends that again. Returns the error; nothing when cancelled.
  static std::optional<double> spend(Patch& tin, std::size_t budget, const Phase& phase) {
    double before = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kBudgetRounds; ++round) {
      // Later rounds are shorter, and often there are none.
      const Phase part = phase.part(1 - std::ldexp(1.0, -round), 1 - std::ldexp(1.0, -round - 1));
      Greedy greedy(tin, 0);
      const auto end = greedy.run(budget, part.part(0, 0.5));
      if (end == Greedy::End::kCancelled) return std::nullopt;
      const double reached = end == Greedy::End::kTargetMet ? 0 : greedy.return_to_best();
      const double tolerance = a_little_above(reached);
      if (!Decimation(tin, tolerance).run(part.part(0.5, 1))) return std::nullopt;
      if (reached == 0 || reached > before * kWorthAnotherRound) return tolerance;
      before = std::min(before, tolerance);
    }
    return before;
  }

  /// An error that was rounded; a little above it the worst sample's own star is not held up.
  static double a_little_above(double error) { return error * (1 + 0x1p-40); }

  /// From a TIN within the budget on: local search makes it smaller, then a smaller error fills it up again.
  std::optional<Reduced> tighten(std::unique_ptr<Patch> tin, double error, std::size_t budget,
                                 const Phase& phase) {
    const int rounds = 3 * rounds_;
    double target = error;
    std::vector<Pin> best;
    tin->collect(best);
    for (int round = 0; round < rounds && !out_of_time(); ++round) {
      const Phase part = phase.part(static_cast<double>(round) / rounds, (round + 1.0) / rounds);
      if (!search(tin, target, part.part(0, 0.7))) return std::nullopt;
      const std::size_t vertices = tin->mesh().vertex_count();
      if (vertices <= budget && target <= error) {
        error = target;
        best.clear();
        tin->collect(best);
      }
      if (round + 1 == rounds) break;
      target = next_target(target, error, vertices, budget, round, rounds);
      take_heights_back(*tin, target);
      if (!repair(tin, target, options_.threads, part.part(0.7, 1))) return std::nullopt;
    }
    tin = std::make_unique<Patch>(samples_, std::span<const Pin>(), best, options_.threads);
    if (best.size() < budget && !out_of_time()) {  // what the last rounds left over
      const auto filled = spend(*tin, budget, phase.part(1, 1));
      if (!filled) return std::nullopt;
      error = std::min(error, *filled);
    }
    return Reduced{std::move(tin), false, error};
  }

  /// Vertices whose fitted heights a smaller tolerance does not allow get their samples' own.
  void take_heights_back(Patch& tin, double tolerance) const {
    if (options_.elevations == Elevations::kSource) return;
    for (std::uint32_t i = 1; i < tin.mesh().vertex_slots(); ++i) {
      const mesh::VertexSlot v(i);
      if (!tin.mesh().is_alive(v)) continue;
      const double own = samples_.site(tin.site(v).sample).z, distance = std::abs(tin.site(v).z - own);
      if (distance > 0 && distance >= tolerance * (1 - 0x1p-40)) tin.set_height(v, own);
    }
  }

  /// At first a little more is asked for than the budget gives, since search will find the rest, and large steps are taken
  /// where it left much of the budget over.
  static double next_target(double target, double best, std::size_t vertices, std::size_t budget, int round,
                            int rounds) {
    const double left = static_cast<double>(rounds - round - 1) / rounds;
    const double wanted = static_cast<double>(budget) * (1 + 0.05 * left);
    const double factor = std::pow(static_cast<double>(vertices) / wanted, 1 / kGrowth);
    return std::min(target * std::clamp(factor, 0.95 - 0.2 * left, 1.05), best);
  }

  const Samples& samples_;
  std::span<const SampleIndex> corners_;
  const Options& options_;
  Random random_;
  int rounds_;
};

}  // namespace

std::optional<Reduced> reduce(const Samples& samples, std::span<const SampleIndex> corners,
                              const Options& options, const Phase& phase) {
  return Reduction(samples, corners, options).run(phase);
}

}  // namespace tin::simplify
