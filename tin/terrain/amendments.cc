#include "tin/terrain/amendments.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "tin/exact/predicates.h"
#include "tin/terrain/digest.h"
#include "tin/terrain/position_buckets.h"
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

/// By the last deed, of those up to `last`, that touched `p`; null: none did. Requires: the touches ascend.
const Touch* last_touch(std::span<const Touch> touches, Point p, DeedNumber last = kAnyDeed) {
  const Touch limit{p, last};
  const auto after = std::upper_bound(touches.begin(), touches.end(), limit,
                                      [](const Touch& a, const Touch& b) { return comes_before(a, b); });
  return after == touches.begin() || std::prev(after)->at != p ? nullptr : &*std::prev(after);
}

/// Where vertices stand that a change made otherwise than they were, and where they stood: ascending.
std::vector<Point> positions_of(std::span<const Step> net) {
  std::vector<Point> positions;
  for (const Step& step : net) {
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

/// Calls visit(sample) for each sample of the grid strictly inside the triangle's area.
template <class Visit>
void visit_inside(const SourceGrid& grid, const EditedTriangle& t, const Visit& visit) {
  const auto [low, high] = box(t);
  const auto columns = cells_between(low.x, high.x, grid.x0, grid.dx, grid.width);
  const auto rows = cells_between(low.y, high.y, grid.y0, grid.dy, grid.height);
  for (std::int64_t row = rows.first; row <= rows.second; ++row) {
    for (std::int64_t column = columns.first; column <= columns.second; ++column) {
      if (is_inside(t, grid.centre(static_cast<std::int32_t>(column), static_cast<std::int32_t>(row))))
        visit(static_cast<std::size_t>(row * grid.width + column));
    }
  }
}

/// Calls visit(sample) for each sample of the source strictly inside one of the areas.
template <class Visit>
void visit_inside(const SourceSamples& source, std::span<const EditedTriangle> areas, const Visit& visit) {
  if (areas.empty()) return;
  if (source.is_raster()) {
    for (const EditedTriangle& t : areas) visit_inside(*source.grid(), t, visit);
    return;
  }
  const auto points = source.positions();
  PositionBuckets buckets(points.size(), [&](std::size_t i) { return points[i]; });
  for (const EditedTriangle& t : areas) {
    const auto [low, high] = box(t);
    buckets.visit(low, high, [&](std::size_t i) {
      const bool inside = is_inside(t, points[i]);
      if (inside) visit(i);
      return inside;
    });
  }
}

/// The terrain's outline: tells what it does not cover. One without a surface covers nothing.
class Outline {
 public:
  explicit Outline(const mesh::Mesh& mesh) {
    if (mesh.dimension() < 2) return;
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
    if (corners_.empty()) return false;
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

/// Whether vertices left the outline, so that it has moved inwards.
bool has_shrunk(const Terrain& after, std::span<const Step> net) {
  const auto leaves = [](const Step& step) { return step.before && (!step.after || step.after->at != step.before->at); };
  if (std::none_of(net.begin(), net.end(), leaves)) return false;
  const Outline outline(after.mesh());
  return std::any_of(net.begin(), net.end(), [&](const Step& step) { return leaves(step) && !outline.covers(step.before->at); });
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
      if (!forget(change.inverse())) take_touches(net_steps(change), fingerprint(change));
      return;
    case Cause::kSimplification:
      return take_simplification(after, change);
    case Cause::kRevert:
      // Journals from before kUndo say it of edits, too.
      if (!forget(change.inverse()) && thinned()) take_simplification(after, change);
      return;
  }
}

bool Amendments::is_off_pixels(const Terrain& terrain, Point p) const {
  const SourceGrid* const grid = terrain.source_grid();
  return kind() == SourceKind::kRaster && grid != nullptr && !grid->cell_centred_at(p);
}

/// The new deed; null: nothing is otherwise than before.
Deed* Amendments::take_touches(std::span<const Step> net, std::uint64_t print) {
  // While all samples are vertices and there is no source, what people touch is a sample as all others.
  if (net.empty() || (kind() == SourceKind::kNone && !thinned())) return nullptr;
  const Deed deed{parts_.next_deed++, print, 0, false};
  for (const Point p : positions_of(net)) parts_.touches.push_back({p, deed.number});
  if (parts_.touches.size() - sorted_ > sorted_ + kFewRecent) {
    parts_.touches = touches();
    sorted_ = parts_.touches.size();
  }
  parts_.deeds.push_back(deed);
  if (parts_.deeds.size() > kMostDeeds) forget_names();
  return &parts_.deeds.back();
}

void Amendments::take_edit(const Terrain& after, const Change& change) {
  const auto net = net_steps(change);
  Deed* const deed = take_touches(net, fingerprint(change));
  if (deed == nullptr || !thinned()) return;
  const auto area = edited_area(after, change);
  parts_.areas.insert(parts_.areas.end(), area.begin(), area.end());
  deed->triangles = area.size();
  deed->shrank = has_shrunk(after, net);
}

/// The older half of the deeds will not be known again: so long after, their undoing touches vertices, and no more.
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

/// Of each position, the last deed up to `last` that touched it or holds it strictly inside its area. Requires: the touches ascend.
std::vector<std::optional<DeedNumber>> Amendments::last_deeds(std::span<const Point> positions,
                                                              std::span<const Touch> all_touches,
                                                              DeedNumber last) const {
  std::vector<std::optional<DeedNumber>> out(positions.size());
  if (!parts_.areas.empty()) {
    PositionBuckets buckets(positions.size(), [&](std::size_t i) { return positions[i]; });
    const auto visit = [&](const EditedTriangle& t, DeedNumber deed) {
      const auto [low, high] = box(t);
      buckets.visit(low, high, [&](std::size_t position) {
        const bool inside = is_inside(t, positions[position]);
        if (inside) out[position] = deed;
        return inside;
      });
    };
    auto area = parts_.areas.end();
    for (auto deed = parts_.deeds.rbegin(); deed != parts_.deeds.rend(); ++deed) {
      for (std::uint64_t i = 0; i < deed->triangles; ++i) {
        --area;
        if (deed->number <= last) visit(*area, deed->number);
      }
    }
    while (area != parts_.areas.begin()) visit(*--area, 0);
  }
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Touch* const touch = last_touch(all_touches, positions[i], last);
    if (touch != nullptr) out[i] = std::max(out[i].value_or(0), touch->deed);
  }
  return out;
}

/// Which of people's samples deeds up to `last` hold or touched that came after them. Their numbers tell the order.
std::vector<bool> Amendments::overruled(std::span<const Touch> all_touches, DeedNumber last) const {
  const auto& own = parts_.own;
  std::vector<Point> positions;
  positions.reserve(own.size());
  for (const OwnSample& one : own) positions.push_back(one.sample.at);
  const auto deeds = last_deeds(positions, all_touches, last);
  std::vector<bool> out(own.size());
  for (std::size_t i = 0; i < own.size(); ++i) out[i] = deeds[i].value_or(0) > own[i].maker;
  return out;
}

/// False: no such edit stands, or others came to the same positions after it, so that it fits by chance only.
bool Amendments::forget(const Change& edit) {
  auto& [kind, thinned, next_deed, deeds, all_touches, areas, own] = parts_;
  const std::uint64_t print = fingerprint(edit);
  std::uint64_t later = 0;  // triangles
  auto deed = deeds.end();
  while (deed != deeds.begin() && std::prev(deed)->fingerprint != print) later += (--deed)->triangles;
  if (deed == deeds.begin()) return false;
  --deed;
  const DeedNumber number = deed->number;
  all_touches = touches();
  sorted_ = all_touches.size();
  for (std::size_t i = 0; i + 1 < all_touches.size(); ++i) {
    if (all_touches[i].deed == number && all_touches[i + 1].at == all_touches[i].at) return false;
  }
  std::erase_if(all_touches, [&](const Touch& touch) { return touch.deed == number; });
  sorted_ = all_touches.size();
  const auto last = areas.end() - static_cast<std::ptrdiff_t>(later);
  areas.erase(last - static_cast<std::ptrdiff_t>(deed->triangles), last);
  std::erase_if(own, [&](const OwnSample& one) { return one.maker == number; });
  deeds.erase(deed);
  return true;
}

/// What goes, or gets another height, stays a sample; where no edit was, the source keeps its own. It is the same when one is
/// undone.
void Amendments::take_simplification(const Terrain& after, const Change& change) {
  if (change.steps.empty()) return;
  set_thinned();
  parts_.touches = touches();
  sorted_ = parts_.touches.size();
  std::vector<Placement> gone;
  std::vector<Point> positions;
  for (const Step& step : change.steps) {
    if (!step.before) continue;
    gone.push_back(*step.before);
    positions.push_back(step.before->at);
  }
  const auto deeds = last_deeds(positions, parts_.touches, kAnyDeed);
  auto& own = parts_.own;
  const auto in_order = [](const OwnSample& a, const OwnSample& b) { return comes_before(a, b); };
  std::vector<OwnSample> more;
  for (std::size_t i = 0; i < gone.size(); ++i) {
    if (!deeds[i] && kind() != SourceKind::kNone && !is_off_pixels(after, gone[i].at)) continue;
    const OwnSample sample{gone[i], deeds[i].value_or(0)};
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

/// Whether people may have removed what made the terrain as large as its samples are.
bool Amendments::may_have_shrunk() const {
  const auto is_unknown = [](const Touch& touch) { return touch.deed == 0; };
  return std::any_of(parts_.deeds.begin(), parts_.deeds.end(), [](const Deed& deed) { return deed.shrank; }) ||
         std::any_of(parts_.touches.begin(), parts_.touches.end(), is_unknown);
}

SourceSamples Amendments::in_force(const SourceSamples& original, const Terrain& terrain) const {
  std::vector<std::size_t> gone;
  for (const Point p : touched()) {
    if (const auto sample = original.find(p)) gone.push_back(*sample);
  }
  visit_inside(original, areas(), [&](std::size_t sample) { gone.push_back(sample); });
  if (may_have_shrunk()) visit_uncovered(original, terrain, [&](std::size_t sample) { gone.push_back(sample); });
  return original.without(gone);
}

std::vector<Placement> Amendments::own_in_force(const Terrain& terrain) const {
  std::vector<Placement> out;
  if (parts_.own.empty()) return out;
  const auto is_out = overruled(touches(), kAnyDeed);
  const bool all_covered = !may_have_shrunk();
  const Outline outline(terrain.mesh());
  for (std::size_t i = 0; i < is_out.size(); ++i) {
    const Placement& sample = parts_.own[i].sample;
    if (!is_out[i] && (all_covered || outline.covers(sample.at))) out.push_back(sample);
  }
  return out;
}

}  // namespace tin::terrain
