#include "tin/simplify/search.h"

#include <algorithm>
#include <cmath>

#include "tin/base/check.h"
#include "tin/delaunay/walk.h"

namespace tin::simplify {

using mesh::kInfinite;
using mesh::TriangleSlot;
using mesh::VertexSlot;

namespace {

// All three were found by experiment, on mountains and plains alike.
constexpr std::uint32_t kPairs = 30;    // percent of the tries that take out two vertices
constexpr std::uint32_t kBeside = 50;   // percent of the insertions beside the worst sample, not there
constexpr std::uint32_t kReach = 1;     // how many cells beside
constexpr std::size_t kBetweenQuestions = 64;  // tries between two looks at whether to stop

constexpr int kHeights = 256;  // so many within the tolerance

/// A power of two; 0 for a tolerance that leaves nothing to fit.
double step_of(const Samples& samples, double tolerance, Elevations elevations) {
  if (elevations == Elevations::kSource || !(tolerance > 0x1p-900 && tolerance < 0x1p+900)) return 0;
  const double step = std::max(samples.fineness(), std::exp2(std::floor(std::log2(tolerance / kHeights))));
  return step <= tolerance ? step : 0;
}

}  // namespace

Search::Search(Patch& patch, double tolerance, Elevations elevations, std::uint64_t seed)
    : patch_(patch), tolerance_(tolerance), step_(step_of(patch.samples(), tolerance, elevations)), random_(seed) {}

void Search::run(std::size_t tries, const std::function<bool()>& stop) {
  if (patch_.mesh().dimension() < 2) return;
  for (std::size_t i = 0; i < tries; ++i) {
    if (i % kBetweenQuestions == 0 && stop()) return;
    attempt();
  }
}

void Search::attempt() {
  const std::uint32_t first = patch_.first_owned(), slots = patch_.mesh().vertex_slots();
  if (first >= slots) return;
  const VertexSlot v(first + random_.below(slots - first));
  if (!patch_.mesh().is_alive(v) || !patch_.is_removable(v)) return;
  changes_.clear();
  bad_.clear();
  witnesses_.clear();
  hole_.clear();
  const VertexSlot other = random_.below(100) < kPairs ? some_neighbour(v) : kInfinite;
  if (!take_out(v)) return;
  if (other != kInfinite && patch_.is_removable(other) && !take_out(other)) return roll_back();
  const std::size_t removed = changes_.size();
  look_into_hole();
  if (mend_by_height() || recreate(removed)) {
    remove_around();
  } else {
    roll_back();
  }
}

VertexSlot Search::some_neighbour(VertexSlot v) {
  patch_.mesh().link(v, link_);
  return patch_.mesh().origin(link_[random_.below(static_cast<std::uint32_t>(link_.size()))]);
}

bool Search::take_out(VertexSlot v) {
  const Site site = patch_.site(v);
  if (!patch_.remove(v)) return false;
  near_ = patch_.fresh().front();
  changes_.push_back({Change::Kind::kRemoved, v, site});
  witnesses_.push_back(site);
  hole_.insert(hole_.end(), patch_.fresh().begin(), patch_.fresh().end());
  return true;
}

void Search::look_into_hole() {
  grow_stamps();
  std::sort(hole_.begin(), hole_.end());
  hole_.erase(std::unique(hole_.begin(), hole_.end()), hole_.end());
  for (const TriangleSlot t : hole_) {
    if (patch_.mesh().is_alive(t)) look_at(t, Depth::kWorst);
  }
}

/// Inserts at most `removed` samples. False when the tolerance is not reached that way.
bool Search::recreate(std::size_t removed) {
  for (std::size_t inserted = 0;; ++inserted) {
    std::erase_if(bad_, [this](const Bad& bad) { return stamps_[bad.triangle.value()] != bad.stamp; });
    if (bad_.empty()) return true;
    if (inserted == removed) return false;
    if (!put_in(bad_[random_.below(static_cast<std::uint32_t>(bad_.size()))], inserted + 1 == removed)) return false;
    grow_stamps();
    for (const TriangleSlot t : patch_.fresh()) ++stamps_[t.value()];
    if (!(inserted + 1 == removed ? is_mended() : look_at_fresh())) return false;
  }
}

/// After the last insertion: whether all is within the tolerance now. What is likely to be over is asked first.
bool Search::is_mended() {
  const auto is_left = [this](const Bad& bad) { return stamps_[bad.triangle.value()] == bad.stamp; };
  if (std::any_of(bad_.begin(), bad_.end(), is_left) || a_witness_is_over()) return false;
  const auto fresh = patch_.fresh();
  return std::none_of(fresh.begin(), fresh.end(), [this](TriangleSlot t) { return look_at(t, Depth::kFirstOver); });
}

bool Search::look_at_fresh() {
  for (const TriangleSlot t : patch_.fresh()) look_at(t, Depth::kWorst);
  return true;
}

/// Makes a sample near the worst one a vertex, or that itself: never what was just taken out, if that can be had.
bool Search::put_in(const Bad& bad, bool is_last) {
  const Samples& samples = patch_.samples();
  Site site = samples.site(bad.sample);
  const bool was_vertex = std::any_of(changes_.begin(), changes_.end(), [&](const Change& change) {
    return change.kind == Change::Kind::kRemoved && change.site.sample == bad.sample;
  });
  if (was_vertex || random_.below(100) < kBeside) {
    const auto offset = [this] {
      return static_cast<std::int32_t>(random_.below(2 * kReach + 1)) - static_cast<std::int32_t>(kReach);
    };
    const std::int32_t columns = offset(), rows = offset();
    if (const auto beside = samples.neighbour(bad.sample, columns, rows)) site = samples.site(*beside);
  }
  const auto v = patch_.insert(site, bad.triangle);
  if (!v) return false;
  near_ = patch_.fresh().front();
  changes_.push_back({Change::Kind::kInserted, *v, {}});
  if (step_ == 0 || !patch_.samples().may_float(site.sample)) return true;
  const auto z = some_height(heights_of(*v));
  if (z) patch_.set_height(*v, *z);
  return z || !is_last;
}

/// Which heights keep all samples over the star within the tolerance, as far as it is up to them.
Heights Search::heights_of(VertexSlot v) const {
  Heights heights;
  const TriangleSlot first = patch_.mesh().triangle_at(v);
  TriangleSlot t = first;
  do {
    const int i = patch_.mesh().index_of(t, v);
    if (!patch_.mesh().is_infinite(t)) {
      const Site &b = patch_.site(patch_.mesh().vertex(t, mesh::next3(i))), &c = patch_.site(patch_.mesh().vertex(t, mesh::prev3(i)));
      patch_.samples().narrow(patch_.site(v), b, c, tolerance_, heights);
    }
    t = patch_.mesh().twin(t, mesh::next3(i)).triangle();
  } while (t != first && heights.any());
  return heights;
}

std::optional<double> Search::some_height(const Heights& heights) {
  const double most = patch_.samples().most();
  const double low = std::ceil(std::max(heights.low, -most) / step_), high = std::floor(std::min(heights.high, most) / step_);
  if (!(low <= high)) return std::nullopt;
  return (low + std::floor(random_.fraction() * (high - low + 1))) * step_;
}

/// Whether another height of a single vertex brings all that is over the tolerance within it.
bool Search::mend_by_height() {
  if (step_ == 0 || bad_.empty()) return false;
  const auto& first = patch_.mesh().triangle(bad_.front().triangle).vertices;
  const std::uint32_t turn = random_.below(3);
  for (std::uint32_t i = 0; i < 3; ++i) {
    const VertexSlot v = first[(i + turn) % 3];
    const bool in_all = std::all_of(bad_.begin(), bad_.end(), [&](const Bad& bad) {
      const auto& corners = patch_.mesh().triangle(bad.triangle).vertices;
      return std::find(corners.begin(), corners.end(), v) != corners.end();
    });
    if (in_all && patch_.is_removable(v) && patch_.samples().may_float(patch_.site(v).sample) && try_height(v)) return true;
  }
  return false;
}

bool Search::try_height(VertexSlot v) {
  const auto z = some_height(heights_of(v));
  if (!z) return false;
  const double before = patch_.site(v).z;
  patch_.set_height(v, *z);
  grow_stamps();
  const auto fresh = patch_.fresh();
  const bool is_over = std::any_of(fresh.begin(), fresh.end(), [this](TriangleSlot t) {
    return !patch_.mesh().is_infinite(t) && patch_.scan(t, tolerance_, Depth::kFirstOver).over;
  });
  if (is_over) {
    patch_.set_height(v, before);
    return false;
  }
  Site site = patch_.site(v);
  site.z = before;
  changes_.push_back({Change::Kind::kRaised, v, site});
  for (const TriangleSlot t : fresh) ++stamps_[t.value()];
  return true;
}

/// Whether one of the samples that were over the tolerance before is so in the star of the last insertion.
bool Search::a_witness_is_over() const {
  for (const TriangleSlot t : patch_.fresh()) {
    if (patch_.mesh().is_infinite(t)) continue;
    const auto& v = patch_.mesh().triangle(t).vertices;
    const Site &a = patch_.site(v[0]), &b = patch_.site(v[1]), &c = patch_.site(v[2]);
    const Facet facet({a.at, a.z}, {b.at, b.z}, {c.at, c.z});
    for (const Site& witness : witnesses_) {
      const auto weights = facet.weights(witness.at);
      if (weights && !facet.judge(*weights, witness.z, tolerance_).within) return true;
    }
  }
  return false;
}

void Search::grow_stamps() {
  if (stamps_.size() < patch_.mesh().triangle_slots()) stamps_.resize(patch_.mesh().triangle_slots() + 64, 0);
}

/// Whether a sample over the triangle is over the tolerance; then notes it.
bool Search::look_at(TriangleSlot t, Depth depth) {
  if (patch_.mesh().is_infinite(t)) return false;
  const Scan scan = patch_.scan(t, tolerance_, depth);
  if (!scan.over) return false;
  bad_.push_back({t, stamps_[t.value()], scan.sample});
  witnesses_.push_back(patch_.samples().site(scan.sample));
  return true;
}

/// A change may have made vertices around it superfluous.
void Search::remove_around() {
  neighbours_.clear();
  for (const Change& change : changes_) {
    if (change.kind == Change::Kind::kRemoved) continue;
    patch_.mesh().link(change.vertex, link_);
    for (const mesh::HalfEdge e : link_) neighbours_.push_back(patch_.mesh().origin(e));
  }
  std::sort(neighbours_.begin(), neighbours_.end());
  neighbours_.erase(std::unique(neighbours_.begin(), neighbours_.end()), neighbours_.end());
  for (const VertexSlot v : neighbours_) {
    if (v == kInfinite || !patch_.is_removable(v)) continue;
    if (trial_.cost_of_removing(patch_, v, tolerance_)) patch_.remove(v);
  }
}

/// The TIN is canonical: it comes back as it was.
void Search::roll_back() {
  for (; !changes_.empty(); changes_.pop_back()) {
    const Change& change = changes_.back();
    switch (change.kind) {
      case Change::Kind::kInserted:
        TIN_CHECK(patch_.remove(change.vertex));
        break;
      case Change::Kind::kRemoved:
        TIN_CHECK(patch_.insert(change.site, delaunay::finite_start(patch_.mesh(), near_)).has_value());
        break;
      case Change::Kind::kRaised:
        patch_.set_height(change.vertex, change.site.z);
        break;
    }
    near_ = patch_.fresh().front();
  }
}

}  // namespace tin::simplify
