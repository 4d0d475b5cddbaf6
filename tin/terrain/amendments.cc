#include "tin/terrain/amendments.h"

#include <algorithm>
#include <utility>

#include "tin/exact/predicates.h"
#include "tin/terrain/terrain.h"

namespace tin::terrain {

using exact::Point;

namespace {

constexpr std::size_t kFewRecent = 1024;

bool before(const Placement& a, const Placement& b) {
  return a.at < b.at;
}

/// Strictly inside the area that the triangle is a part of: in the triangle, and not on an edge where the
/// area ends.
bool is_inside(const EditedTriangle& t, Point p) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t side = exact::orientation(t.corners[(i + 1) % 3], t.corners[(i + 2) % 3], p);
    if (side < 0 || (side == 0 && ((t.inner >> i) & 1U) == 0)) return false;
  }
  return p != t.corners[0] && p != t.corners[1] && p != t.corners[2];
}

std::pair<Point, Point> box(const EditedTriangle& t) {
  const auto& [a, b, c] = t.corners;
  return {{std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y})},
          {std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y})}};
}

/// Columns or rows whose centres lie in [low, high]: first, last.
std::pair<std::int64_t, std::int64_t> cells_between(std::int64_t low, std::int64_t high, std::int64_t origin,
                                                    std::int64_t step, std::int64_t count) {
  const auto floor_of = [](std::int64_t a, std::int64_t b) {
    return a / b - (a % b != 0 && (a < 0) != (b < 0) ? 1 : 0);
  };
  if (step < 0) {
    std::swap(low, high);
  }
  // The least i with origin + i * step on or past `low` in the direction of step, and the largest not past
  // `high`.
  const std::int64_t first = -floor_of(origin - low, step), last = floor_of(high - origin, step);
  return {std::max<std::int64_t>(first, 0), std::min(last, count - 1)};
}

/// Calls visit(sample) for each sample of the source strictly inside the triangle's area.
template <class Visit>
void visit_inside(const SourceSamples& source, const EditedTriangle& t, const Visit& visit) {
  const auto [low, high] = box(t);
  if (!source.is_raster()) {
    const auto points = source.positions();
    for (auto p = std::lower_bound(points.begin(), points.end(), low); p != points.end() && p->x <= high.x;
         ++p) {
      if (is_inside(t, *p)) visit(static_cast<std::size_t>(p - points.begin()));
    }
    return;
  }
  const SourceGrid& grid = *source.grid();
  const auto columns = cells_between(low.x, high.x, grid.x0, grid.dx, grid.width);
  const auto rows = cells_between(low.y, high.y, grid.y0, grid.dy, grid.height);
  for (std::int64_t row = rows.first; row <= rows.second; ++row) {
    for (std::int64_t column = columns.first; column <= columns.second; ++column) {
      if (is_inside(t, grid.centre(static_cast<std::int32_t>(column), static_cast<std::int32_t>(row))))
        visit(static_cast<std::size_t>(row * grid.width + column));
    }
  }
}

/// The terrain's outline: tells what it does not cover. Requires: dimension 2.
class Outline {
 public:
  explicit Outline(const mesh::Mesh& mesh) {
    std::vector<mesh::HalfEdge> link;
    mesh.link(mesh::kInfinite, link);
    for (const mesh::HalfEdge e : link) {
      const Point at = mesh.point(mesh.origin(e));
      while (corners_.size() > 1 &&
             exact::orientation(corners_[corners_.size() - 2], corners_.back(), at) == 0)
        corners_.pop_back();
      corners_.push_back(at);
    }
  }

  bool covers(Point p) const {
    Point from = corners_.back();
    for (const Point to : corners_) {  // clockwise
      if (exact::orientation(from, to, p) > 0) return false;
      from = to;
    }
    return true;
  }

 private:
  std::vector<Point> corners_;
};

/// Calls visit(sample) for each sample of the source, void pixels among them, that lies outside the terrain.
template <class Visit>
void visit_uncovered(const SourceSamples& source, const Terrain& terrain, const Visit& visit) {
  const Outline outline(terrain.mesh());
  const auto visit_unless_covered = [&](std::size_t i) {
    if (outline.covers(source.at(i))) return false;
    visit(i);
    return true;
  };
  const std::size_t row = source.is_raster() ? static_cast<std::size_t>(source.grid()->width) : 1;
  for (std::size_t begin = 0; begin < source.size(); begin += row) {
    // The outline is convex: what is covered of a row is one stretch.
    std::size_t first = begin, last = begin + row;
    while (first < last && visit_unless_covered(first)) ++first;
    while (first < last && visit_unless_covered(last - 1)) --last;
  }
}

}  // namespace

Amendments::Amendments(SourceKind kind, bool thinned, std::vector<Point> touched,
                       std::vector<EditedTriangle> areas, std::vector<Placement> own)
    : kind_(kind),
      thinned_(thinned),
      touched_(std::move(touched)),
      sorted_(touched_.size()),
      areas_(std::move(areas)),
      own_(std::move(own)) {}

std::vector<Point> Amendments::touched() const {
  std::vector<Point> all = touched_;
  std::sort(all.begin() + static_cast<std::ptrdiff_t>(sorted_), all.end());
  std::inplace_merge(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(sorted_), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

std::size_t Amendments::bytes() const {
  return touched_.capacity() * sizeof(Point) + areas_.capacity() * sizeof(EditedTriangle) +
         own_.capacity() * sizeof(Placement);
}

void Amendments::take(const Terrain& after, const Change& change) {
  switch (change.cause) {
    case Cause::kEdit:
      return take_edit(after, change);
    case Cause::kRevert:
      return;
    case Cause::kSimplification:
      return take_simplification(after, change);
  }
}

bool Amendments::is_off_pixels(const Terrain& terrain, Point p) const {
  const SourceGrid* const grid = terrain.source_grid();
  return kind_ == SourceKind::kRaster && grid != nullptr && !grid->cell_centred_at(p);
}

void Amendments::add_touched(Point p, const Terrain& terrain) {
  // Without a source every vertex is a sample, and off the pixels of a raster there is none to be put out of
  // force.
  if (kind_ == SourceKind::kNone || is_off_pixels(terrain, p)) return;
  touched_.push_back(p);
  if (touched_.size() - sorted_ <= sorted_ + kFewRecent) return;
  touched_ = touched();
  sorted_ = touched_.size();
}

void Amendments::take_edit(const Terrain& after, const Change& change) {
  std::vector<Point> positions;
  for (const Step& step : change.steps) {
    if (step.before) positions.push_back(step.before->at);
    if (step.after) positions.push_back(step.after->at);
  }
  std::sort(positions.begin(), positions.end());
  positions.erase(std::unique(positions.begin(), positions.end()), positions.end());
  for (const Point p : positions) add_touched(p, after);
  if (!thinned_) return;
  const auto area = edited_area(after, change);
  drop_own(after, positions, area);
  if (kind_ != SourceKind::kNone) areas_.insert(areas_.end(), area.begin(), area.end());
}

/// People's samples that are no vertices give way to later edits as the source's do.
void Amendments::drop_own(const Terrain& after, std::span<const Point> touched,
                          std::span<const EditedTriangle> areas) {
  if (own_.empty()) return;
  if (after.mesh().dimension() < 2) return own_.clear();
  std::vector<bool> gone(own_.size(), false);
  for (const Point p : touched) {
    const auto at = std::lower_bound(own_.begin(), own_.end(), Placement{p, 0}, before);
    if (at != own_.end() && at->at == p) gone[static_cast<std::size_t>(at - own_.begin())] = true;
  }
  for (const EditedTriangle& t : areas) {
    const auto [low, high] = box(t);
    for (auto at = std::lower_bound(own_.begin(), own_.end(), Placement{low, 0}, before);
         at != own_.end() && at->at.x <= high.x; ++at) {
      if (is_inside(t, at->at)) gone[static_cast<std::size_t>(at - own_.begin())] = true;
    }
  }
  const Outline outline(after.mesh());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < own_.size(); ++i) {
    if (!gone[i] && outline.covers(own_[i].at)) own_[kept++] = own_[i];
  }
  own_.resize(kept);
}

/// What goes, or gets another height, stays a sample; the source keeps its own.
void Amendments::take_simplification(const Terrain& after, const Change& change) {
  if (change.steps.empty()) return;
  thinned_ = true;
  const auto edited = touched();
  std::vector<Placement> more;
  for (const Step& step : change.steps) {
    if (!step.before) continue;
    const Point p = step.before->at;
    const bool is_peoples = kind_ == SourceKind::kNone || is_off_pixels(after, p) ||
                            std::binary_search(edited.begin(), edited.end(), p);
    if (is_peoples && !std::binary_search(own_.begin(), own_.end(), *step.before, before))
      more.push_back(*step.before);
  }
  std::sort(more.begin(), more.end(), before);
  const auto middle = static_cast<std::ptrdiff_t>(own_.size());
  own_.insert(own_.end(), more.begin(), more.end());
  std::inplace_merge(own_.begin(), own_.begin() + middle, own_.end(), before);
}

std::vector<Point> Amendments::rim(const Terrain& terrain) const {
  const auto edited = touched();
  std::vector<Point> out;
  for (const EditedTriangle& t : areas_) {
    for (const Point corner : t.corners) {
      // Off the pixels of a raster there are vertices of people's only.
      if (!is_off_pixels(terrain, corner) && !std::binary_search(edited.begin(), edited.end(), corner))
        out.push_back(corner);
    }
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

SourceSamples Amendments::in_force(const SourceSamples& original, const Terrain& terrain) const {
  std::vector<std::size_t> gone;
  for (const Point p : touched()) {
    if (const auto sample = original.find(p)) gone.push_back(*sample);
  }
  for (const EditedTriangle& t : areas_)
    visit_inside(original, t, [&](std::size_t sample) { gone.push_back(sample); });
  // Only who removes vertices makes a terrain smaller than its samples.
  if (!touched_.empty())
    visit_uncovered(original, terrain, [&](std::size_t sample) { gone.push_back(sample); });
  return original.without(gone);
}

}  // namespace tin::terrain
