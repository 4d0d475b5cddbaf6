#include "tin/terrain/amendments.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "tin/exact/predicates.h"
#include "tin/terrain/digest.h"
#include "tin/terrain/terrain.h"

namespace tin::terrain {

using exact::Point;

namespace {

constexpr std::size_t kFewRecent = 1024;
constexpr std::size_t kMostDeeds = std::size_t{1} << 17;
constexpr DeedNumber kAnyDeed = std::numeric_limits<DeedNumber>::max();

bool comes_before(const Touch& a, const Touch& b) {
  return a.at != b.at ? a.at < b.at : a.deed < b.deed;
}

bool comes_before(const OwnSample& a, const OwnSample& b) {
  return a.sample.at != b.sample.at ? a.sample.at < b.sample.at : a.maker < b.maker;
}

/// The last deed, of those up to `last`, that touched `p`; nothing: none did. Requires: the touches ascend.
std::optional<DeedNumber> last_to_touch(std::span<const Touch> touches, Point p, DeedNumber last = kAnyDeed) {
  const Touch limit{p, last};
  const auto after = std::upper_bound(touches.begin(), touches.end(), limit,
                                      [](const Touch& a, const Touch& b) { return comes_before(a, b); });
  if (after == touches.begin() || std::prev(after)->at != p) return std::nullopt;
  return std::prev(after)->deed;
}

/// What a change comes to: where vertices that it changes stood before and stand after it, ascending.
std::vector<Point> positions_of(const Change& change) {
  std::vector<Point> positions;
  for (const Step& step : net_steps(change)) {
    if (step.before) positions.push_back(step.before->at);
    if (step.after) positions.push_back(step.after->at);
  }
  std::sort(positions.begin(), positions.end());
  positions.erase(std::unique(positions.begin(), positions.end()), positions.end());
  return positions;
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

/// Calls visit(index) for each of the samples, which ascend, strictly inside the triangle's area.
template <class Visit>
void visit_inside(std::span<const OwnSample> samples, const EditedTriangle& t, const Visit& visit) {
  const auto [low, high] = box(t);
  for (auto at = std::lower_bound(samples.begin(), samples.end(), low,
                                  [](const OwnSample& one, Point p) { return one.sample.at < p; });
       at != samples.end() && at->sample.at.x <= high.x; ++at) {
    if (is_inside(t, at->sample.at)) visit(static_cast<std::size_t>(at - samples.begin()));
  }
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

Amendments::Parts Amendments::parts() const {
  Parts out = parts_;
  out.touches = touches();
  return out;
}

std::vector<Touch> Amendments::touches() const {
  std::vector<Touch> all = parts_.touches;
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(sorted_);
  const auto in_order = [](const Touch& a, const Touch& b) { return comes_before(a, b); };
  std::sort(middle, all.end(), in_order);
  std::inplace_merge(all.begin(), middle, all.end(), in_order);
  return all;
}

std::vector<Point> Amendments::touched() const {
  std::vector<Point> out;
  for (const Touch& touch : touches()) {
    if (out.empty() || out.back() != touch.at) out.push_back(touch.at);
  }
  return out;
}

std::size_t Amendments::bytes() const {
  return parts_.deeds.capacity() * sizeof(Deed) + parts_.touches.capacity() * sizeof(Touch) +
         parts_.areas.capacity() * sizeof(EditedTriangle) + parts_.own.capacity() * sizeof(OwnSample);
}

void Amendments::take(const Terrain& after, const Change& change) {
  switch (change.cause) {
    case Cause::kEdit:
      return take_edit(after, change);
    case Cause::kUndo:
      return take_undo(after, change);
    case Cause::kSimplification:
      return take_simplification(after, change);
    case Cause::kRevert:
      return;
  }
}

bool Amendments::is_off_pixels(const Terrain& terrain, Point p) const {
  const SourceGrid* const grid = terrain.source_grid();
  return kind() == SourceKind::kRaster && grid != nullptr && !grid->cell_centred_at(p);
}

void Amendments::take_edit(const Terrain& after, const Change& change) {
  // While all samples are vertices and there is no source, what people touch is a sample as all others.
  if (kind() == SourceKind::kNone && !thinned()) return;
  const auto positions = positions_of(change);
  if (positions.empty()) return;
  Deed deed{parts_.next_deed++, fingerprint(change), 0};
  for (const Point p : positions) parts_.touches.push_back({p, deed.number});
  if (parts_.touches.size() - sorted_ > sorted_ + kFewRecent) {
    parts_.touches = touches();
    sorted_ = parts_.touches.size();
  }
  if (thinned()) {
    const auto area = edited_area(after, change);
    parts_.areas.insert(parts_.areas.end(), area.begin(), area.end());
    deed.triangles = area.size();
  }
  parts_.deeds.push_back(deed);
  if (parts_.deeds.size() > kMostDeeds) forget_names();
}

/// The older half of the deeds will not be known again: so long after, their undoing is an edit.
void Amendments::forget_names() {
  auto& [kind, thinned, next_deed, deeds, all_touches, areas, own] = parts_;
  all_touches = touches();
  const auto half = deeds.begin() + static_cast<std::ptrdiff_t>(deeds.size() / 2);
  const DeedNumber last = std::prev(half)->number;
  const auto is_out = overruled(all_touches, last);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (is_out[i]) continue;
    own[kept] = own[i];
    if (own[kept].maker <= last) own[kept].maker = 0;
    ++kept;
  }
  own.resize(kept);
  for (Touch& touch : all_touches) {
    if (touch.deed <= last) touch.deed = 0;
  }
  all_touches.erase(std::unique(all_touches.begin(), all_touches.end()), all_touches.end());
  sorted_ = all_touches.size();
  deeds.erase(deeds.begin(), half);
}

/// Which of people's samples deeds up to `last` hold that came after them. Their numbers tell the order.
std::vector<bool> Amendments::overruled(std::span<const Touch> all_touches, DeedNumber last) const {
  const auto& own = parts_.own;
  std::vector<bool> out(own.size());
  auto area = parts_.areas.end();
  for (auto deed = parts_.deeds.rbegin(); deed != parts_.deeds.rend(); ++deed) {
    for (std::uint64_t i = 0; i < deed->triangles; ++i) {
      --area;
      if (deed->number > last) continue;
      visit_inside(own, *area, [&](std::size_t sample) {
        if (own[sample].maker < deed->number) out[sample] = true;
      });
    }
  }
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (last_to_touch(all_touches, own[i].sample.at, last).value_or(0) > own[i].maker) out[i] = true;
  }
  return out;
}

void Amendments::take_undo(const Terrain& after, const Change& change) {
  const std::uint64_t undone = fingerprint(change.inverse());
  const auto deed = std::find_if(parts_.deeds.rbegin(), parts_.deeds.rend(),
                                 [&](const Deed& one) { return one.fingerprint == undone; });
  if (deed == parts_.deeds.rend()) return take_edit(after, change);
  forget(static_cast<std::size_t>(parts_.deeds.rend() - deed) - 1);
}

void Amendments::forget(std::size_t deed) {
  auto& [kind, thinned, next_deed, deeds, touches, areas, own] = parts_;
  const DeedNumber number = deeds[deed].number;
  std::uint64_t later = 0;
  for (std::size_t i = deed + 1; i < deeds.size(); ++i) later += deeds[i].triangles;
  const auto last = areas.end() - static_cast<std::ptrdiff_t>(later);
  areas.erase(last - static_cast<std::ptrdiff_t>(deeds[deed].triangles), last);
  const auto sorted = std::remove_if(touches.begin(), touches.begin() + static_cast<std::ptrdiff_t>(sorted_),
                                     [&](const Touch& touch) { return touch.deed == number; });
  const auto recent = touches.erase(sorted, touches.begin() + static_cast<std::ptrdiff_t>(sorted_));
  sorted_ = static_cast<std::size_t>(recent - touches.begin());
  touches.erase(std::remove_if(recent, touches.end(), [&](const Touch& touch) { return touch.deed == number; }),
                touches.end());
  std::erase_if(own, [&](const OwnSample& one) { return one.maker == number; });
  deeds.erase(deeds.begin() + static_cast<std::ptrdiff_t>(deed));
}

/// What goes, or gets another height, stays a sample; the source keeps its own.
void Amendments::take_simplification(const Terrain& after, const Change& change) {
  if (change.steps.empty()) return;
  set_thinned();
  parts_.touches = touches();
  sorted_ = parts_.touches.size();
  auto& own = parts_.own;
  const auto in_order = [](const OwnSample& a, const OwnSample& b) { return comes_before(a, b); };
  std::vector<OwnSample> more;
  for (const Step& step : change.steps) {
    if (!step.before) continue;
    const Point p = step.before->at;
    const auto maker = last_to_touch(parts_.touches, p);
    if (!maker && kind() != SourceKind::kNone && !is_off_pixels(after, p)) continue;
    const OwnSample sample{*step.before, maker.value_or(0)};
    if (!std::binary_search(own.begin(), own.end(), sample, in_order)) more.push_back(sample);
  }
  std::sort(more.begin(), more.end(), in_order);
  const auto middle = static_cast<std::ptrdiff_t>(own.size());
  own.insert(own.end(), more.begin(), more.end());
  std::inplace_merge(own.begin(), own.begin() + middle, own.end(), in_order);
}

std::vector<Point> Amendments::rim(const Terrain& terrain) const {
  const auto edited = touched();
  std::vector<Point> out;
  for (const EditedTriangle& t : areas()) {
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
  const auto edited = touched();
  std::vector<std::size_t> gone;
  for (const Point p : edited) {
    if (const auto sample = original.find(p)) gone.push_back(*sample);
  }
  for (const EditedTriangle& t : areas())
    visit_inside(original, t, [&](std::size_t sample) { gone.push_back(sample); });
  // Only who removes vertices makes a terrain smaller than its samples.
  if (!edited.empty())
    visit_uncovered(original, terrain, [&](std::size_t sample) { gone.push_back(sample); });
  return original.without(gone);
}

std::vector<Placement> Amendments::own_in_force(const Terrain& terrain) const {
  std::vector<Placement> out;
  if (parts_.own.empty() || terrain.mesh().dimension() < 2) return out;
  const auto is_out = overruled(touches(), kAnyDeed);
  const Outline outline(terrain.mesh());
  for (std::size_t i = 0; i < is_out.size(); ++i) {
    const Placement& sample = parts_.own[i].sample;
    if (!is_out[i] && outline.covers(sample.at)) out.push_back(sample);
  }
  return out;
}

}  // namespace tin::terrain
