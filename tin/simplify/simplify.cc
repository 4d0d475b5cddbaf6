#include "tin/simplify/simplify.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "tin/base/check.h"
#include "tin/simplify/certificate.h"
#include "tin/simplify/greedy.h"
#include "tin/simplify/phase.h"
#include "tin/simplify/reduce.h"
#include "tin/simplify/samples.h"

namespace tin::simplify {

using base::Code;
using base::error;
using base::Result;
using mesh::VertexSlot;
using terrain::Placement;
using terrain::SourceSamples;
using terrain::Terrain;

namespace {

Result<void> check(const Options& options) {
  if (!options.tolerance && !options.max_vertices) {
    return error(Code::kInvalidValue, "Either a tolerance or a number of vertices is needed.");
  }
  if (options.tolerance && !(std::isfinite(*options.tolerance) && *options.tolerance >= 0)) {
    return error(Code::kInvalidValue, "The tolerance must be a finite number and not negative.");
  }
  return {};
}

Demands demands_of(const Options& options, Footprint& footprint) {
  return {options.elevations == Elevations::kFit,
          options.keep_flat,
          options.against == Against::kSurface,
          options.threads,
          options.memory,
          &footprint};
}

/// Why there is no result.
base::Error stopped(const Footprint& footprint) {
  if (!footprint.is_over()) return error(Code::kCancelled, "Cancelled.");
  return error(Code::kTooLarge, "The simplification takes more memory than there is room for: " +
                                    std::to_string((footprint.bytes() >> 20) + 1) + " MB and more.");
}

Result<void> check_budget(const Options& options, std::size_t needed) {
  if (!options.max_vertices || *options.max_vertices >= needed) return {};
  return error(Code::kInvalidValue, "This terrain needs at least " + std::to_string(needed) + " vertices.");
}

/// The vertices chosen, by sample, and what is to be said of them.
struct Choice {
  std::vector<Pin> pins;
  Report report;
};

std::vector<Pin> all_samples(const Samples& samples) {
  std::vector<Pin> pins;
  for (SampleIndex i = 0; i < samples.end(); ++i) {
    if (samples.exists(i)) pins.push_back({samples.site(i).z, i, true, true});
  }
  return pins;
}

std::optional<Worst> worst_of(const Samples& samples, const SourceSamples* source, const Certificate& certificate) {
  if (certificate.worst_edge) {
    const EdgeScan& edge = *certificate.worst_edge;
    return Worst{samples.position(edge.from), edge.height, edge.error, Worst::Between{samples.position(edge.to), edge.along},
                 std::nullopt};
  }
  if (!certificate.worst) return std::nullopt;
  const Site site = samples.site(*certificate.worst);
  Worst out{site.at, site.z, certificate.max_error, std::nullopt, std::nullopt};
  const auto index = source == nullptr ? std::nullopt : source->find(site.at);
  if (index && source->z(*index) == site.z) out.source_index = index;
  return out;
}

/// What never goes: the corners of the hull, and what the options protect.
std::vector<SampleIndex> with_protected(const Samples& samples, std::vector<SampleIndex> corners, const Options& options) {
  std::vector<SampleIndex> more;
  for (const exact::Point p : options.protect) {
    if (const auto sample = samples.find(p)) more.push_back(*sample);
  }
  std::sort(more.begin(), more.end());
  more.erase(std::unique(more.begin(), more.end()), more.end());
  std::vector<SampleIndex> hull = corners;
  std::sort(hull.begin(), hull.end());
  std::set_difference(more.begin(), more.end(), hull.begin(), hull.end(), std::back_inserter(corners));
  return corners;
}

/// What is to be said of a TIN, and its vertices.
Result<Choice> certified(std::unique_ptr<Patch> tin, const SourceSamples* source, double asked, double bin, unsigned threads,
                         const Footprint& footprint, const Phase& phase) {
  const Samples& samples = tin->samples();
  const auto certificate = certify(*tin, asked, bin, threads, phase);
  if (!certificate) return stopped(footprint);
  Choice out;
  tin->collect(out.pins);
  tin.reset();
  std::sort(out.pins.begin(), out.pins.end(), [](const Pin& a, const Pin& b) { return a.sample < b.sample; });
  out.report.vertices_after = out.pins.size();
  out.report.samples = certificate->samples;
  out.report.crossings = certificate->crossings;
  out.report.level = certificate->level;
  out.report.max_error = certificate->max_error;
  out.report.worst = worst_of(samples, source, *certificate);
  out.report.rmse = certificate->rmse;
  out.report.histogram = certificate->histogram;
  out.report.bin = bin;
  out.report.tolerance_met = certificate->within;
  return out;
}

Result<Choice> choose(const Samples& samples, const SourceSamples* source, const Options& options,
                      const Footprint& footprint, const Phase& whole) {
  const auto corners = hull_corners(samples, samples.extent().box);
  if (corners.size() < 3) {  // all in a line, or nearly none
    Choice out{all_samples(samples), {}};
    if (auto fine = check_budget(options, out.pins.size()); !fine) return fine.error();
    out.report.samples = out.report.vertices_after = out.pins.size();
    out.report.histogram[0] = out.report.samples;
    return out;
  }
  const auto fixed = with_protected(samples, corners, options);
  if (auto fine = check_budget(options, fixed.size()); !fine) return fine.error();
  auto reduced = reduce(samples, fixed, options, whole.part(0, 0.9));
  if (!reduced) return stopped(footprint);
  const double asked = options.tolerance.value_or(std::numeric_limits<double>::max());
  const double bin = (reduced->to_tolerance ? asked : reduced->error) / kBins;
  auto out = certified(std::move(reduced->tin), source, asked, bin, options.threads, footprint, whole.part(0.9, 1));
  if (!out) return out;
  TIN_CHECK(out->report.tolerance_met || !reduced->to_tolerance);
  whole.report(1);
  return out;
}

/// The vertices of `start` that are samples, with their heights there if the tolerance allows these, and what never goes.
std::vector<Pin> pins_of(const Terrain& start, const Samples& samples, const Options& options) {
  std::vector<Pin> pins;
  for (const SampleIndex fixed : with_protected(samples, hull_corners(samples, samples.extent().box), options))
    pins.push_back({samples.site(fixed).z, fixed, true});
  for (const terrain::Vertex& vertex : start.vertices_by_id()) {
    const auto sample = samples.find(vertex.at);
    if (!sample) continue;
    const double own = samples.site(*sample).z, distance = std::abs(vertex.z - own);
    pins.push_back({distance < *options.tolerance * (1 - 0x1p-40) ? vertex.z : own, *sample});
  }
  const auto comes_before = [](const Pin& a, const Pin& b) { return a.sample < b.sample; };
  std::stable_sort(pins.begin(), pins.end(), comes_before);  // what never goes before others of the same sample
  const auto is_same = [](const Pin& a, const Pin& b) { return a.sample == b.sample; };
  pins.erase(std::unique(pins.begin(), pins.end(), is_same), pins.end());
  return pins;
}

/// How `terrain` becomes what was chosen.
Outcome difference(const Terrain& terrain, const Samples& samples, Choice choice) {
  Outcome out;
  const auto& pins = choice.pins;
  std::vector<bool> is_there(pins.size(), false);
  for (auto id = terrain.ids().first_from(terrain::VertexId(0)); id;
       id = terrain.ids().first_from(terrain::VertexId(id->value() + 1))) {
    const auto sample = samples.find(terrain.mesh().point(*terrain.slot_of(*id)));
    TIN_CHECK(sample.has_value());
    const auto pin = std::lower_bound(pins.begin(), pins.end(), *sample,
                                      [](const Pin& left, SampleIndex right) { return left.sample < right; });
    if (pin == pins.end() || pin->sample != *sample) {
      out.removed.push_back(*id);
    } else {
      is_there[static_cast<std::size_t>(pin - pins.begin())] = true;
      if (pin->z != terrain.vertex(*id)->z) out.reset.push_back({*id, terrain.vertex(*id)->at, pin->z});
    }
  }
  for (std::size_t i = 0; i < pins.size(); ++i) {
    if (!is_there[i]) out.inserted.push_back({samples.position(pins[i].sample), pins[i].z});
  }
  std::sort(out.inserted.begin(), out.inserted.end(), [](const Placement& a, const Placement& b) { return a.at < b.at; });
  out.report = choice.report;
  out.report.vertices_before = terrain.vertex_count();
  return out;
}

}  // namespace

Result<Outcome> simplify(const Terrain& terrain, const SourceSamples* source, std::span<const Placement> own,
                         const Options& options, base::Progress* progress) {
  if (auto fine = check(options); !fine) return fine.error();
  Footprint footprint(options.room);
  const Phase whole = Phase(progress, 0, 1).until(footprint.is_over());
  const auto samples = make_samples(&terrain, source, own, demands_of(options, footprint), progress);
  if (!samples) return stopped(footprint);
  auto choice = choose(*samples, source, options, footprint, whole.part(0.05, 1));
  if (!choice) return choice.error();
  return difference(terrain, *samples, std::move(*choice));
}

Result<Outcome> mend(const Terrain& terrain, const SourceSamples* source, std::span<const Placement> own,
                     const Terrain& start, const Options& options, base::Progress* progress) {
  if (auto fine = check(options); !fine) return fine.error();
  TIN_CHECK(options.tolerance.has_value());
  Footprint footprint(options.room);
  const Phase whole = Phase(progress, 0, 1).until(footprint.is_over());
  const auto samples = make_samples(&terrain, source, own, demands_of(options, footprint), progress);
  if (!samples) return stopped(footprint);
  auto tin = std::make_unique<Patch>(*samples, std::span<const Pin>(), pins_of(start, *samples, options),
                                     options.threads);
  const auto end = Greedy(*tin, *options.tolerance).run(Greedy::kNoBudget, whole.part(0.2, 0.8));
  if (end == Greedy::End::kCancelled) return stopped(footprint);
  auto choice = certified(std::move(tin), source, *options.tolerance, *options.tolerance / kBins, options.threads,
                          footprint, whole.part(0.8, 1));
  if (!choice) return choice.error();
  return difference(terrain, *samples, std::move(*choice));
}

Result<Chosen> simplify_samples(const SourceSamples& source, const Options& options, base::Progress* progress) {
  if (auto fine = check(options); !fine) return fine.error();
  Footprint footprint(options.room);
  const Phase whole = Phase(progress, 0, 1).until(footprint.is_over());
  const auto samples = make_samples(nullptr, &source, {}, demands_of(options, footprint), progress);
  if (!samples) return stopped(footprint);
  auto choice = choose(*samples, &source, options, footprint, whole.part(0.05, 1));
  if (!choice) return choice.error();
  Chosen out{{}, choice->report};
  out.report.vertices_before = out.report.samples;
  out.vertices.reserve(choice->pins.size());
  for (const Pin& pin : choice->pins) out.vertices.push_back({samples->position(pin.sample), pin.z});
  return out;
}

}  // namespace tin::simplify
