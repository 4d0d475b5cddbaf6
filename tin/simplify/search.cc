#include "tin/simplify/search.h"

#include "tin/base/check.h"
#include <cstdio>
#include <cstdlib>

namespace tin::simplify {

using mesh::kInfinite;
using mesh::TriangleSlot;
using mesh::VertexSlot;

namespace {
struct Count { long tried[3]{}, ok[3][3]{}; ~Count(){ fprintf(stderr,"1: %ld ->0 %ld ->1 %ld ; 2: %ld ->0 %ld ->1 %ld ->2 %ld\n",tried[1],ok[1][0],ok[1][1],tried[2],ok[2][0],ok[2][1],ok[2][2]); } } g_count;
int env(const char*n,int d){ const char*v=getenv(n); return v?atoi(v):d; }
const int kPair=env("PAIR",60), kNear=env("NEAR",50), kR=env("R",1), env_same=env("SAME",1);
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
  const VertexSlot other = (int)random_.below(100) < kPair ? some_neighbour(v) : kInfinite;
  if (!take_out(v)) return;
  if (other != kInfinite && patch_.is_removable(other) && !take_out(other)) return roll_back();
  const auto n = changes_.size(); ++g_count.tried[n];
  if (!recreate(n)) roll_back(); else ++g_count.ok[n][changes_.size()-n];
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
  note_bad(Depth::kWorst);
  return true;
}

/// Inserts at most `removed` samples. False when the tolerance is not reached that way.
bool Search::recreate(std::size_t removed) {
  for (std::size_t inserted = 0;; ++inserted) {
    std::erase_if(bad_, [this](const Bad& bad) { return is_outdated(bad); });
    if (bad_.empty()) return true;
    if (inserted == removed) return false;
    if (!put_in(bad_[random_.below(static_cast<std::uint32_t>(bad_.size()))])) return false;
    if (!note_bad(inserted + 1 == removed ? Depth::kFirstOver : Depth::kWorst)) return false;
  }
}

bool Search::is_outdated(const Bad& bad) const {
  return stamps_[bad.triangle.value()] != bad.stamp || !patch_.mesh().is_alive(bad.triangle);
}

bool Search::is_removed(SampleIndex s) const {
  for (const Change& c : changes_) if (!c.inserted && c.site.sample == s) return true;
  return false;
}

/// Makes a sample near the worst one a vertex, or that itself.
bool Search::put_in(const Bad& bad) {
  const Samples& samples = patch_.samples();
  Site site = samples.site(bad.sample);
  const bool same = env_same && is_removed(bad.sample);
  if (same || (int)random_.below(100) < kNear) {
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

/// Looks at the triangles that the last change made. With kFirstOver: false once one is over the tolerance.
bool Search::note_bad(Depth depth) {
  if (stamps_.size() < patch_.mesh().triangle_slots()) stamps_.resize(patch_.mesh().triangle_slots() + 64, 0);
  for (const TriangleSlot t : patch_.fresh()) {
    const std::uint32_t stamp = ++stamps_[t.value()];
    if (patch_.mesh().is_infinite(t)) continue;
    const Scan scan = patch_.scan(t, tolerance_, depth);
    if (!scan.over) continue;
    if (depth == Depth::kFirstOver) return false;
    bad_.push_back({t, stamp, scan.sample});
  }
  return true;
}

/// The TIN is canonical: it comes back as it was.
void Search::roll_back() {
  for (; !changes_.empty(); changes_.pop_back()) {
    const Change& change = changes_.back();
    if (change.inserted) {
      TIN_CHECK(patch_.remove(change.vertex));
      near_ = patch_.fresh().front();
    } else {
      TIN_CHECK(patch_.insert(change.site, delaunay::finite_start(patch_.mesh(), near_)).has_value());
      near_ = patch_.fresh().front();
    }
  }
}

}  // namespace tin::simplify
