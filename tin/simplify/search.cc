#include "tin/simplify/search.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "tin/base/check.h"
#include "tin/delaunay/walk.h"

namespace tin::simplify {

using mesh::kInfinite;
using mesh::TriangleSlot;
using mesh::VertexSlot;

namespace {
struct Count { long tried[3]{}, ok[3][3]{}, fol{}, folok{}, wit{},full{},fullfail{}; ~Count(){ fprintf(stderr,"1: %ld ->0 %ld ->1 %ld ; 2: %ld ->0 %ld ->1 %ld ->2 %ld follow %ld ok %ld witness %ld full %ld fail %ld\n",tried[1],ok[1][0],ok[1][1],tried[2],ok[2][0],ok[2][1],ok[2][2],fol,folok,wit,full,fullfail); } } g_count;
int env(const char*n,int d){ const char*v=getenv(n); return v?atoi(v):d; }
const int kPair=env("PAIR",60), kNear=env("NEAR",50), kR=env("R",1), kFollow=env("FOLLOW",1), kWit=env("WIT",1);
constexpr std::size_t kBetweenQuestions = 64;  // tries between two looks at whether to stop
}

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
  const VertexSlot other = (int)random_.below(100) < kPair ? some_neighbour(v) : kInfinite;
  if (!take_out(v)) return;
  if (other != kInfinite && patch_.is_removable(other) && !take_out(other)) return roll_back();
  look_into_hole();
  const std::size_t removed = changes_.size();
  ++g_count.tried[removed];
  if (!recreate(removed)) return roll_back();
  ++g_count.ok[removed][changes_.size()-removed];
  if (kFollow) follow_up();
}

void Search::follow_up() {
  neighbours_.clear();
  for (const Change& change : changes_) {
    if (!change.inserted) continue;
    patch_.mesh().link(change.vertex, link_);
    for (const mesh::HalfEdge e : link_) neighbours_.push_back(patch_.mesh().origin(e));
  }
  std::sort(neighbours_.begin(), neighbours_.end());
  neighbours_.erase(std::unique(neighbours_.begin(), neighbours_.end()), neighbours_.end());
  for (const VertexSlot v : neighbours_) {
    if (v == kInfinite || !patch_.mesh().is_alive(v) || !patch_.is_removable(v)) continue;
    ++g_count.fol;
    if (!trial_.cost_of_removing(patch_, v, tolerance_)) continue;
    g_count.folok += patch_.remove(v);
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
  changes_.push_back({false, v, site});
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
    if (!put_in(bad_[random_.below(static_cast<std::uint32_t>(bad_.size()))])) return false;
    grow_stamps();
    const bool last = inserted + 1 == removed;
    for (const TriangleSlot t : patch_.fresh()) ++stamps_[t.value()];
    if (last) {
      for (const Bad& bad : bad_) if (stamps_[bad.triangle.value()] == bad.stamp) return false;
      if (kWit && a_witness_is_over()) { ++g_count.wit; return false; }
      ++g_count.full;
    }
    for (const TriangleSlot t : patch_.fresh()) {
      if (look_at(t, last ? Depth::kFirstOver : Depth::kWorst) && last) { ++g_count.fullfail; return false; }
    }
  }
}

bool Search::is_removed(SampleIndex sample) const {
  return std::any_of(changes_.begin(), changes_.end(), [sample](const Change& change) { return !change.inserted && change.site.sample == sample; });
}

/// Makes a sample near the worst one a vertex, or that itself.
bool Search::put_in(const Bad& bad) {
  const Samples& samples = patch_.samples();
  Site site = samples.site(bad.sample);
  if (is_removed(bad.sample) || (int)random_.below(100) < kNear) {
    const auto offset = [this] { return static_cast<std::int32_t>(random_.below(2*kR+1)) - kR; };
    const auto near = samples.neighbour(bad.sample, offset(), offset());
    if (near) site = samples.site(*near);
  }
  const auto v = patch_.insert(site, bad.triangle);
  if (!v) return false;
  near_ = patch_.fresh().front();
  changes_.push_back({true, *v, {}});
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

/// The TIN is canonical: it comes back as it was.
void Search::roll_back() {
  for (; !changes_.empty(); changes_.pop_back()) {
    const Change& change = changes_.back();
    if (change.inserted) {
      TIN_CHECK(patch_.remove(change.vertex));
    } else {
      TIN_CHECK(patch_.insert(change.site, delaunay::finite_start(patch_.mesh(), near_)).has_value());
    }
    near_ = patch_.fresh().front();
  }
}

}  // namespace tin::simplify
