#include "tin/query/contour.h"

#include <algorithm>
#include <cmath>

#include "tin/query/order.h"

namespace tin::query {

using base::Code;
using base::error;
using frame::Place;
using mesh::HalfEdge;
using mesh::next3;
using mesh::TriangleSlot;
using mesh::VertexSlot;

base::Result<std::vector<double>> contour_levels(const terrain::Terrain& terrain, double interval,
                                                 double base, std::size_t most) {
  if (!(interval > 0) || !std::isfinite(interval))
    return error(Code::kInvalidValue, "The interval must be greater than 0.");
  std::vector<double> levels;
  const auto range = terrain.z_range();
  if (!range) return levels;
  const double first = std::ceil((range->min - base) / interval),
               last = std::floor((range->max - base) / interval);
  if (!(last - first < static_cast<double>(most))) {
    return error(Code::kTooLarge,
                 "There would be more than " + std::to_string(most) + " levels, the limit here.");
  }
  for (double k = first; k <= last; ++k) {
    const double level = base + k * interval;
    if (!levels.empty() && !(level > levels.back())) {
      return error(Code::kInvalidValue, "The interval is too small for elevations of this size.");
    }
    levels.push_back(level);
  }
  return levels;
}

ContourTracer::ContourTracer(const terrain::Terrain& terrain, std::vector<double> levels,
                             const ContourOptions& options)
    : terrain_(terrain),
      mesh_(terrain.mesh()),
      levels_(std::move(levels)),
      box_(options.box),
      voids_(terrain, options.voids) {
  if (mesh_.dimension() == 2) sort_by_level();
}

/// Each triangle goes to the first level above its lowest corner, in the order of ids, if it reaches that
/// level.
void ContourTracer::sort_by_level() {
  seen_.assign(mesh_.triangle_slots(), 0);
  std::vector<std::uint32_t> order, first;
  begins_.assign(levels_.size() + 1, 0);
  TriangleWalk walk(terrain_, {});
  while (const auto view = walk.next()) {
    const auto& v = view->slots;
    const auto [low, high] = std::minmax({terrain_.z(v[0]), terrain_.z(v[1]), terrain_.z(v[2])});
    const auto level =
        static_cast<std::size_t>(std::upper_bound(levels_.begin(), levels_.end(), low) - levels_.begin());
    if (level == levels_.size() || levels_[level] > high) continue;
    if (box_) {
      const auto p = mesh_.point(v[0]), q = mesh_.point(v[1]), r = mesh_.point(v[2]);
      if (std::max({p.x, q.x, r.x}) < box_->min.x || std::min({p.x, q.x, r.x}) > box_->max.x ||
          std::max({p.y, q.y, r.y}) < box_->min.y || std::min({p.y, q.y, r.y}) > box_->max.y) {
        continue;
      }
    }
    // The triangle by a half-edge's bits would do as well; any of its corners finds it in the star of the
    // smallest.
    TriangleSlot t = mesh_.triangle_at(v[0]);
    while (mesh_.vertex(t, next3(mesh_.index_of(t, v[0]))) != v[1]) {
      t = mesh_.twin(t, next3(mesh_.index_of(t, v[0]))).triangle();
    }
    order.push_back(t.value());
    first.push_back(static_cast<std::uint32_t>(level));
    ++begins_[level + 1];
  }
  for (std::size_t i = 0; i < levels_.size(); ++i) begins_[i + 1] += begins_[i];
  triangles_.resize(order.size());
  std::vector<std::size_t> next(begins_.begin(), begins_.end() - 1);
  for (std::size_t i = 0; i < order.size(); ++i) triangles_[next[first[i]]++] = order[i];
}

double ContourTracer::fraction() const {
  return levels_.empty() || mesh_.dimension() < 2
             ? 1
             : static_cast<double>(level_index_) / static_cast<double>(levels_.size());
}

bool ContourTracer::begin_level() {
  if (mesh_.dimension() < 2 || level_index_ == levels_.size()) return false;
  level_ = levels_[level_index_];
  std::erase_if(active_, [this](std::uint32_t t) { return !crosses(TriangleSlot(t)); });
  active_.insert(active_.end(), triangles_.begin() + static_cast<std::ptrdiff_t>(begins_[level_index_]),
                 triangles_.begin() + static_cast<std::ptrdiff_t>(begins_[level_index_ + 1]));
  ++level_index_;
  at_ = 0;
  return true;
}

bool ContourTracer::next(ContourLine& line) {
  while (ready_.empty()) {
    if (at_ == active_.size()) {
      if (!begin_level()) return false;
      continue;
    }
    const TriangleSlot t(active_[at_++]);
    if (seen_[t.value()] != level_index_) trace(t);
  }
  line = std::move(ready_.back());
  ready_.pop_back();
  return true;
}

bool ContourTracer::crosses(TriangleSlot t) const {
  const auto& v = mesh_.triangle(t).vertices;
  const int count = above(v[0]) + above(v[1]) + above(v[2]);
  return count == 1 || count == 2;
}

/// The edge over which the line comes in: its origin, to the left, is above and its destination below.
HalfEdge ContourTracer::entry(TriangleSlot t) const {
  for (int i = 0; i < 3; ++i) {
    const HalfEdge e(t, i);
    if (above(mesh_.origin(e)) && !above(mesh_.destination(e))) return e;
  }
  TIN_CHECK(false);
}

HalfEdge ContourTracer::exit(TriangleSlot t) const {
  for (int i = 0; i < 3; ++i) {
    const HalfEdge e(t, i);
    if (!above(mesh_.origin(e)) && above(mesh_.destination(e))) return e;
  }
  TIN_CHECK(false);
}

Place ContourTracer::crossing(HalfEdge edge) const {
  VertexSlot u = mesh_.origin(edge), v = mesh_.destination(edge);
  if (mesh_.point(v) < mesh_.point(u)) std::swap(u, v);
  const Place a = frame::place(mesh_.point(u)), b = frame::place(mesh_.point(v));
  const double za = terrain_.z(u), zb = terrain_.z(v);
  if (za == level_) return a;
  if (zb == level_) return b;
  const double part = (level_ - za) / (zb - za);
  return {a.x + part * (b.x - a.x), a.y + part * (b.y - a.y)};
}

/// Places in order, and the triangle between each and the next.
struct ContourTracer::Path {
  bool closed = false;
  std::vector<Place> places;
  std::vector<TriangleSlot> triangles;  // one fewer
};

void ContourTracer::trace(TriangleSlot t) {
  const auto seen = static_cast<std::uint32_t>(level_index_);
  Path path;
  // Back to where the line comes in from the hull; a ring comes round to t.
  TriangleSlot first = t;
  for (;;) {
    const TriangleSlot before = mesh_.twin(entry(first)).triangle();
    if (mesh_.is_infinite(before)) break;
    first = before;
    path.closed = first == t;
    if (path.closed) break;
  }
  path.places.push_back(crossing(entry(first)));
  for (TriangleSlot at = first;;) {
    seen_[at.value()] = seen;
    const HalfEdge out = exit(at);
    path.places.push_back(crossing(out));
    path.triangles.push_back(at);
    at = mesh_.twin(out).triangle();
    if (at == first || mesh_.is_infinite(at)) break;
  }
  emit(path);
}

namespace {

/// The part of a segment inside a box, as fractions; nothing when it is outside or only touches.
std::optional<Interval> inside(const PlaceBox& box, Place a, Place b) {
  Interval part;
  const auto cut = [&part](double from, double to, double low, double high) {
    const double along = to - from;
    if (along == 0) return from >= low && from <= high;
    const double t0 = (low - from) / along, t1 = (high - from) / along;
    part.from = std::max(part.from, std::min(t0, t1));
    part.to = std::min(part.to, std::max(t0, t1));
    return true;
  };
  if (!cut(a.x, b.x, box.min.x, box.max.x) || !cut(a.y, b.y, box.min.y, box.max.y)) return std::nullopt;
  if (part.from >= part.to) return std::nullopt;
  return part;
}

/// Parts of a line, put together from parts of its segments.
class LineParts {
 public:
  explicit LineParts(double level) : level_(level) {}

  void segment(Place a, Place b, Interval part) {
    const auto at = [&](double t) {
      if (t <= 0) return a;
      if (t >= 1) return b;
      return Place{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
    };
    if (part.from > 0 || !running_) begin(at(part.from));
    add(at(part.to));
    running_ = part.to >= 1;
  }
  void nothing() { running_ = false; }
  bool running() const { return running_; }

  std::vector<ContourLine> take() { return std::move(lines_); }

 private:
  void begin(Place p) {
    lines_.push_back({level_, false, {p}});
    running_ = true;
  }
  void add(Place p) {
    if (lines_.back().places.back() != p) lines_.back().places.push_back(p);
  }

  double level_;
  bool running_ = false;
  std::vector<ContourLine> lines_;
};

}  // namespace

void ContourTracer::emit(const Path& path) {
  LineParts parts(level_);
  std::vector<Interval> solid;
  const auto cut_by_box = [&](Place a, Place b, Interval part) {
    if (box_) {
      const auto within = inside(*box_, a, b);
      if (!within) return parts.nothing();
      part = {std::max(part.from, within->from), std::min(part.to, within->to)};
      if (part.from >= part.to) return parts.nothing();
    }
    parts.segment(a, b, part);
  };
  for (std::size_t i = 0; i < path.triangles.size(); ++i) {
    const Place a = path.places[i], b = path.places[i + 1];
    if (a == b) continue;
    if (!voids_.may_touch(mesh_.triangle(path.triangles[i]).vertices)) {
      cut_by_box(a, b, {});
      continue;
    }
    voids_.solid_parts(a, b, solid);
    if (solid.empty()) parts.nothing();
    for (const Interval& part : solid) cut_by_box(a, b, part);
    if (!solid.empty() && solid.back().to < 1) parts.nothing();
  }
  const bool runs_on = parts.running();
  ready_ = parts.take();
  if (path.closed && ready_.size() > 1 && runs_on &&
      ready_.front().places.front() == ready_.back().places.back()) {
    // The ring began within a part.
    auto& tail = ready_.back().places;
    const auto& head = ready_.front().places;
    tail.insert(tail.end(), head.begin() + 1, head.end());
    ready_.erase(ready_.begin());
  }
  for (ContourLine& line : ready_) {
    // Also one from hull to hull that begins and ends at the same vertex on the level.
    line.closed = line.places.size() > 2 && line.places.front() == line.places.back();
  }
  std::erase_if(ready_, [](const ContourLine& line) { return line.places.size() < 2; });
  std::reverse(ready_.begin(), ready_.end());
}

}  // namespace tin::query
