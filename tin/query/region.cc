#include "tin/query/region.h"

#include <algorithm>
#include <optional>

#include "tin/exact/predicates.h"

namespace tin::query {

using base::Code;
using base::error;
using base::Result;
using exact::Int128;
using exact::orientation;
using exact::Point;

namespace {

int sign(std::int64_t v) {
  return (v > 0) - (v < 0);
}

/// Of collinear points: whether p lies between a and b, ends included.
bool between(Point a, Point b, Point p) {
  return std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
         p.y <= std::max(a.y, b.y);
}

bool meet(Point a, Point b, Point c, Point d) {
  if (std::max(a.x, b.x) < std::min(c.x, d.x) || std::max(c.x, d.x) < std::min(a.x, b.x) ||
      std::max(a.y, b.y) < std::min(c.y, d.y) || std::max(c.y, d.y) < std::min(a.y, b.y)) {
    return false;
  }
  const int c_side = sign(orientation(a, b, c)), d_side = sign(orientation(a, b, d));
  const int a_side = sign(orientation(c, d, a)), b_side = sign(orientation(c, d, b));
  if (c_side * d_side < 0 && a_side * b_side < 0) return true;
  return (c_side == 0 && between(a, b, c)) || (d_side == 0 && between(a, b, d)) ||
         (a_side == 0 && between(c, d, a)) || (b_side == 0 && between(c, d, b));
}

Int128 twice_area(const Ring& ring) {
  Int128 sum = 0;
  for (std::size_t i = 2; i < ring.size(); ++i) sum += orientation(ring[0], ring[i - 1], ring[i]);
  return sum;
}

/// The edge from i to the next position.
struct Edge {
  std::size_t ring, at;
  Point a, b;
};

std::vector<Edge> edges_by_x(std::span<const Ring> rings) {
  std::vector<Edge> edges;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    for (std::size_t i = 0; i < rings[r].size(); ++i)
      edges.push_back({r, i, rings[r][i], rings[r][(i + 1) % rings[r].size()]});
  }
  std::sort(edges.begin(), edges.end(),
            [](const Edge& l, const Edge& r) { return std::min(l.a, l.b) < std::min(r.a, r.b); });
  return edges;
}

/// Neighbours in a ring share an end and may share nothing else.
bool fold_back(const Edge& first, const Edge& second) {
  return orientation(first.a, first.b, second.b) == 0 &&
         (between(first.a, first.b, second.b) || between(second.a, second.b, first.a));
}

std::optional<Edge> clash(std::span<const Ring> rings) {
  const auto edges = edges_by_x(rings);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Edge& e = edges[i];
    const std::int32_t right = std::max(e.a.x, e.b.x);
    for (std::size_t j = i + 1; j < edges.size() && std::min(edges[j].a.x, edges[j].b.x) <= right; ++j) {
      const Edge& f = edges[j];
      if (!meet(e.a, e.b, f.a, f.b)) continue;
      const std::size_t size = rings[e.ring].size();
      const bool e_then_f = e.ring == f.ring && (e.at + 1) % size == f.at,
                 f_then_e = e.ring == f.ring && (f.at + 1) % size == e.at;
      if (e_then_f || f_then_e) {
        if (e_then_f ? fold_back(e, f) : fold_back(f, e)) return f;
      } else {
        return f;
      }
    }
  }
  return std::nullopt;
}

/// Whether p, on no edge, lies inside the ring: by the edges to its right.
bool inside(const Ring& ring, Point p) {
  bool in = false;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    Point a = ring[i], b = ring[(i + 1) % ring.size()];
    if (a.y > b.y) std::swap(a, b);
    if (a.y <= p.y && p.y < b.y && orientation(a, b, p) > 0) in = !in;
  }
  return in;
}

/// Cuts ears off a simple ring that turns counter-clockwise.
class EarCutter {
 public:
  EarCutter(const Ring& ring, std::vector<Region::Triangle>& out) : ring_(ring), out_(out) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      next_.push_back((i + 1) % ring.size());
      last_.push_back((i + ring.size() - 1) % ring.size());
    }
  }

  void run() {
    std::size_t at = 0;
    for (std::size_t left = ring_.size(); left > 3;) {
      const std::int64_t turn = turn_at(at);
      if (turn > 0 && !is_ear(at)) {
        at = next_[at];
        continue;
      }
      if (turn < 0) {
        at = next_[at];
        continue;
      }
      if (turn > 0) out_.push_back({ring_[last_[at]], ring_[at], ring_[next_[at]]});
      next_[last_[at]] = next_[at];
      last_[next_[at]] = last_[at];
      at = next_[next_[at]];  // leaps, so that a fan does not become slivers
      --left;
    }
    if (turn_at(at) > 0) out_.push_back({ring_[last_[at]], ring_[at], ring_[next_[at]]});
  }

 private:
  std::int64_t turn_at(std::size_t i) const {
    return orientation(ring_[last_[i]], ring_[i], ring_[next_[i]]);
  }

  /// Whether no other corner lies in the closed triangle that would be cut off; only reflex ones can.
  bool is_ear(std::size_t i) const {
    const Point a = ring_[last_[i]], b = ring_[i], c = ring_[next_[i]];
    for (std::size_t j = next_[next_[i]]; j != last_[i]; j = next_[j]) {
      const Point p = ring_[j];
      if (orientation(a, b, p) >= 0 && orientation(b, c, p) >= 0 && orientation(c, a, p) >= 0) return false;
    }
    return true;
  }

  const Ring& ring_;
  std::vector<Region::Triangle>& out_;
  std::vector<std::size_t> next_, last_;
};

Ring without_repeats(const Ring& ring) {
  Ring out;
  for (const Point p : ring) {
    if (out.empty() || out.back() != p) out.push_back(p);
  }
  while (out.size() > 1 && out.back() == out.front()) out.pop_back();
  return out;
}

}  // namespace

Result<Region> Region::make(std::span<const Ring> rings) {
  std::vector<Ring> clean;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    clean.push_back(without_repeats(rings[r]));
    if (clean.back().size() < 3)
      return error(Code::kInvalidValue, "The ring has no area.", "/" + std::to_string(r));
  }
  if (clean.empty()) return error(Code::kInvalidValue, "A polygon needs a ring.");
  if (const auto edge = clash(clean)) {
    return error(Code::kInvalidValue, "The polygon crosses or touches itself.",
                 "/" + std::to_string(edge->ring) + "/" + std::to_string(edge->at));
  }
  Region region;
  for (std::size_t r = 0; r < clean.size(); ++r) {
    Ring& ring = clean[r];
    const Int128 area = twice_area(ring);
    if (area == 0) return error(Code::kInvalidValue, "The ring has no area.", "/" + std::to_string(r));
    if (area < 0) std::reverse(ring.begin(), ring.end());
    bool placed = r == 0 || inside(clean[0], ring[0]);
    for (std::size_t other = 1; other < clean.size() && r > 0; ++other) {
      if (other != r) placed = placed && !inside(clean[other], ring[0]);
    }
    if (!placed)
      return error(Code::kInvalidValue, "The hole is not inside the outline, or in another hole.",
                   "/" + std::to_string(r));
    EarCutter(ring, r == 0 ? region.outline_ : region.holes_).run();
  }
  return region;
}

}  // namespace tin::query
