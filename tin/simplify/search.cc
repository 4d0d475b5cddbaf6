#include "tin/simplify/search.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tin/base/check.h"
#include "tin/delaunay/walk.h"
#include "tin/exact/predicates.h"

namespace tin::simplify {

using mesh::kInfinite;
using mesh::TriangleSlot;
using mesh::VertexSlot;

namespace {

// All were found by experiment, on mountains and plains alike.
constexpr std::uint32_t kPairs = 70;           // percent of the tries that take out two vertices
constexpr std::uint32_t kNeighbours = 4;       // drawn for the second of two; it is the nearest of them
constexpr std::uint32_t kBeside = 75;          // percent of the insertions beside the worst sample, not there
constexpr std::uint32_t kDraws = 16;           // places that are drawn for the last vertex of a try
constexpr std::uint32_t kDrawsForTwo = 8;      // for one vertex instead of two, which is possible less often
constexpr std::uint32_t kDrawsForFirst = 4;    // for the first of two insertions
constexpr std::size_t kSpots = 8;              // so many of them are tried at most
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
    : patch_(patch),
      tolerance_(tolerance),
      step_(step_of(patch.samples(), tolerance, elevations)),
      cell_(patch.samples().extent().step_x * patch.samples().extent().step_y),
      random_(seed) {}

void Search::run(std::size_t tries, const std::function<bool()>& stop) {
  if (patch_.mesh().dimension() < 2) return;
  patch_.note_unsettled(&unsettled_);
  for (std::size_t i = 0; i < tries && (i % kBetweenQuestions != 0 || !stop()); ++i) attempt();
  patch_.note_unsettled(nullptr);
}

void Search::attempt() {
  const std::uint32_t first = patch_.first_owned(), slots = patch_.mesh().vertex_slots();
  if (first >= slots) return;
  const VertexSlot v(first + random_.below(slots - first));
  if (!patch_.mesh().is_alive(v) || !patch_.is_removable(v)) return;
  changes_.clear();
  bad_.clear();
  witnesses_.clear();
  unsettled_.clear();
  changed_.clear();
  hole_.clear();
  const VertexSlot other = random_.below(100) < kPairs ? some_neighbour(v) : kInfinite;
  if (other != kInfinite && patch_.is_removable(other)) {
    change_two(v, other);
  } else {
    change_one(v);
  }
}

/// Nothing is changed before it is known where another vertex might make up for this one.
void Search::change_one(VertexSlot v) {
  trial_.visit_hole(patch_, v, [this](VertexSlot a, VertexSlot b, VertexSlot c) { look_at({a, b, c}); });
  const Site site = patch_.site(v);
  if (!bad_.empty()) find_spots({&site, 1}, kDraws);
  if (!bad_.empty() && spots_.empty() && step_ == 0) return patch_.settle(v);
  if (!take_out(v)) return;
  bad_.empty() || mend_by_height() || insert_last() ? remove_around() : roll_back();
}

/// One vertex instead of two is what makes the TIN smaller; two others let it wander.
void Search::change_two(VertexSlot v, VertexSlot other) {
  if (!take_out(v)) return;
  if (!take_out(other)) return roll_back();
  look_into_hole();
  if (bad_.empty() || mend_by_height()) return remove_around();
  const std::array removed{changes_[0].site, changes_[1].site};
  find_spots(removed, kDrawsForTwo);
  if (insert_last()) return remove_around();
  if (!insert_first(removed)) return roll_back();
  if (!bad_.empty()) find_spots(removed, kDraws);
  bad_.empty() || insert_last() ? remove_around() : roll_back();
}

/// A near one rather than others: of two vertices that are near each other one is needed less.
VertexSlot Search::some_neighbour(VertexSlot v) {
  const mesh::Mesh& mesh = patch_.mesh();
  mesh.link(v, link_);
  VertexSlot nearest = kInfinite;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < kNeighbours; ++i) {
    const VertexSlot drawn = mesh.origin(link_[random_.below(static_cast<std::uint32_t>(link_.size()))]);
    if (drawn == kInfinite) continue;
    const double x = static_cast<double>(mesh.point(drawn).x) - mesh.point(v).x,
                 y = static_cast<double>(mesh.point(drawn).y) - mesh.point(v).y;
    if (x * x + y * y >= least) continue;
    least = x * x + y * y;
    nearest = drawn;
  }
  return nearest;
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
  std::sort(hole_.begin(), hole_.end());
  hole_.erase(std::unique(hole_.begin(), hole_.end()), hole_.end());
  for (const TriangleSlot t : hole_) {
    if (patch_.mesh().is_alive(t) && !patch_.mesh().is_infinite(t))
      look_at(patch_.mesh().triangle(t).vertices);
  }
}

/// Notes whether a sample over the triangle is over the tolerance.
void Search::look_at(const std::array<VertexSlot, 3>& corners) {
  const Scan scan = patch_.samples().scan(patch_.site(corners[0]), patch_.site(corners[1]),
                                          patch_.site(corners[2]), tolerance_, Depth::kWorst);
  if (!scan.over) return;
  bad_.push_back({corners, patch_.samples().site(scan.sample)});
  witnesses_.push_back(bad_.back().worst);
}

/// Whether a vertex at `p` would do away with the triangle.
bool Search::concerns(const Bad& bad, exact::Point p) const {
  const mesh::Mesh& mesh = patch_.mesh();
  const exact::Point a = mesh.point(bad.corners[0]), b = mesh.point(bad.corners[1]),
                     c = mesh.point(bad.corners[2]);
  return p != a && p != b && p != c && exact::in_circle(a, b, c, p);
}

/// The first of two insertions: of a few places the one that does away with most triangles over the tolerance.
bool Search::insert_first(std::span<const Site> removed) {
  Site site;
  std::ptrdiff_t most = -1;
  for (std::uint32_t i = 0; i < kDrawsForFirst; ++i) {
    const Site drawn = some_spot(some_bad(), removed);
    const auto done_away_with =
        std::count_if(bad_.begin(), bad_.end(), [&](const Bad& bad) { return concerns(bad, drawn.at); });
    if (done_away_with <= most) continue;
    most = done_away_with;
    site = drawn;
  }
  const auto v = patch_.insert(site, delaunay::finite_start(patch_.mesh(), near_));
  if (!v) return false;
  near_ = patch_.fresh().front();
  changes_.push_back({Change::Kind::kInserted, *v, {}});
  if (step_ != 0 && patch_.samples().may_float(site.sample)) {
    if (const auto z = some_height(heights_of(*v))) patch_.set_height(*v, *z);
  }
  std::erase_if(bad_, [&](const Bad& old) { return concerns(old, site.at); });
  for (const TriangleSlot t : patch_.fresh()) {
    if (!patch_.mesh().is_infinite(t)) look_at(patch_.mesh().triangle(t).vertices);
  }
  return true;
}

/// Draws a few places for the last vertex: where it does away with all triangles over the tolerance.
void Search::find_spots(std::span<const Site> removed, std::uint32_t draws) {
  spots_.clear();
  for (std::uint32_t i = 0; i < draws && spots_.size() < kSpots; ++i) {
    const Site site = some_spot(some_bad(), removed);
    const auto is_concerned = [&](const Bad& bad) { return concerns(bad, site.at); };
    const auto is_same = [&](const Site& spot) { return spot.sample == site.sample; };
    if (std::all_of(bad_.begin(), bad_.end(), is_concerned) &&
        std::none_of(spots_.begin(), spots_.end(), is_same)) {
      spots_.push_back(site);
    }
  }
}

bool Search::insert_last() {
  for (Site& site : spots_) {
    if (!patch_.carve(site, delaunay::finite_start(patch_.mesh(), near_)) || !fits(site)) continue;
    const VertexSlot v = patch_.fill(site);
    near_ = patch_.fresh().front();
    changes_.push_back({Change::Kind::kInserted, v, {}});
    return true;
  }
  return false;
}

/// Whether all samples over the star that was carved for a vertex would be within the tolerance. What is
/// likely to be over is asked first.
bool Search::fits(Site& site) {
  if (step_ != 0 && patch_.samples().may_float(site.sample)) {
    const auto z = some_height(heights_of_carved(site));
    if (!z) return false;
    site.z = *z;
  }
  const auto visit = [this](const auto& look) {
    return patch_.visit_carved([&](VertexSlot from, VertexSlot to) {
      return from == kInfinite || to == kInfinite || look(patch_.site(from), patch_.site(to));
    });
  };
  if (!visit([&](const Site& b, const Site& c) { return !a_witness_is_over(site, b, c); })) return false;
  return visit([&](const Site& b, const Site& c) {
    const Scan scan = patch_.samples().scan(site, b, c, tolerance_, Depth::kFirstOver);
    if (scan.over) witnesses_.push_back(patch_.samples().site(scan.sample));
    return !scan.over;
  });
}

/// How many cells beside the worst sample: more where triangles are large.
std::uint32_t Search::reach_over(const Bad& bad) const {
  constexpr std::int64_t kFew = 20, kMany = 100;  // cells in twice the triangle
  const mesh::Mesh& mesh = patch_.mesh();
  const std::int64_t cells =
      exact::orientation(mesh.point(bad.corners[0]), mesh.point(bad.corners[1]), mesh.point(bad.corners[2])) /
      cell_;
  return cells < kFew ? 1 : cells < kMany ? 2 : 3;
}

/// Near the worst sample, or that itself: never what was just taken out, if that can be had.
Site Search::some_spot(const Bad& bad, std::span<const Site> removed) {
  const bool was_vertex = std::any_of(removed.begin(), removed.end(),
                                      [&](const Site& site) { return site.sample == bad.worst.sample; });
  if (!was_vertex && random_.below(100) >= kBeside) return bad.worst;
  const std::uint32_t reach = reach_over(bad);
  const auto offset = [this, reach] {
    return static_cast<std::int32_t>(random_.below(2 * reach + 1)) - static_cast<std::int32_t>(reach);
  };
  const std::int32_t columns = offset(), rows = offset();
  return patch_.samples().beside(bad.worst, columns, rows).value_or(bad.worst);
}

/// Which heights keep all samples over the star within the tolerance, as far as it is up to them.
Heights Search::heights_of(VertexSlot v) const {
  Heights heights;
  const TriangleSlot first = patch_.mesh().triangle_at(v);
  TriangleSlot t = first;
  do {
    const int i = patch_.mesh().index_of(t, v);
    if (!patch_.mesh().is_infinite(t)) {
      const Site &b = patch_.site(patch_.mesh().vertex(t, mesh::next3(i))),
                 &c = patch_.site(patch_.mesh().vertex(t, mesh::prev3(i)));
      patch_.samples().narrow(patch_.site(v), b, c, tolerance_, heights);
    }
    t = patch_.mesh().twin(t, mesh::next3(i)).triangle();
  } while (t != first && heights.any());
  return heights;
}

Heights Search::heights_of_carved(const Site& site) const {
  Heights heights;
  patch_.visit_carved([&](VertexSlot from, VertexSlot to) {
    if (from == kInfinite || to == kInfinite) return true;
    patch_.samples().narrow(site, patch_.site(from), patch_.site(to), tolerance_, heights);
    return heights.any();
  });
  return heights;
}

std::optional<double> Search::some_height(const Heights& heights) {
  const double most = patch_.samples().most();
  const double low = std::ceil(std::max(heights.low, -most) / step_),
               high = std::floor(std::min(heights.high, most) / step_);
  if (!(low <= high)) return std::nullopt;
  return (low + std::floor(random_.fraction() * (high - low + 1))) * step_;
}

/// Whether another height of a single vertex brings all that is over the tolerance within it.
bool Search::mend_by_height() {
  if (step_ == 0 || bad_.empty()) return false;
  const auto& first = bad_.front().corners;
  const std::uint32_t turn = random_.below(3);
  for (std::uint32_t i = 0; i < 3; ++i) {
    const VertexSlot v = first[(i + turn) % 3];
    const bool in_all = std::all_of(bad_.begin(), bad_.end(), [&](const Bad& bad) {
      return std::find(bad.corners.begin(), bad.corners.end(), v) != bad.corners.end();
    });
    if (in_all && patch_.is_removable(v) && patch_.samples().may_float(patch_.site(v).sample) &&
        try_height(v))
      return true;
  }
  return false;
}

bool Search::try_height(VertexSlot v) {
  const auto z = some_height(heights_of(v));
  if (!z) return false;
  const double before = patch_.site(v).z;
  patch_.set_height(v, *z);
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
  return true;
}

/// Whether one of the samples that were over the tolerance before is so in this triangle.
bool Search::a_witness_is_over(const Site& a, const Site& b, const Site& c) const {
  const Facet facet({a.at, a.z}, {b.at, b.z}, {c.at, c.z});
  return std::any_of(witnesses_.begin(), witnesses_.end(), [&](const Site& witness) {
    const auto weights = facet.weights(witness.at);
    return weights && !facet.judge(*weights, witness.z, tolerance_).within;
  });
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
    if (!trial_.cost_of_removing(patch_, v, tolerance_)) {
      patch_.settle(v);
    } else {
      patch_.remove(v);
    }
  }
}

/// The TIN is canonical: it comes back as it was.
void Search::roll_back() {
  for (; !changes_.empty(); changes_.pop_back()) {
    const Change& change = changes_.back();
    switch (change.kind) {
      case Change::Kind::kInserted:
        TIN_CHECK(patch_.remove(change.vertex));
        changed_.push_back(change.vertex);
        break;
      case Change::Kind::kRemoved: {
        const auto v = patch_.insert(change.site, delaunay::finite_start(patch_.mesh(), near_));
        TIN_CHECK(v.has_value());
        changed_.push_back(*v);
        changed_.push_back(change.vertex);
        break;
      }
      case Change::Kind::kRaised:
        patch_.set_height(change.vertex, change.site.z);
        break;
    }
    near_ = patch_.fresh().front();
  }
  settle_again();
}

/// After a try that was taken back: stars are as they were. Slots may belong to other vertices than before
/// where some were taken out.
void Search::settle_again() {
  for (const VertexSlot v : unsettled_) {
    if (std::find(changed_.begin(), changed_.end(), v) == changed_.end()) patch_.settle(v);
  }
}

}  // namespace tin::simplify
