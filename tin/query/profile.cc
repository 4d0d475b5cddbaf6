#include "tin/query/profile.h"

#include "tin/query/segment_walk.h"

namespace tin::query {

using base::Code;
using base::error;
using base::Result;
using exact::Point;
using frame::Place;

namespace {

class ProfileBuilder {
 public:
  ProfileBuilder(const frame::Ground& ground, std::size_t max_points) : ground_(ground), most_(max_points) {}

  /// The surface passes here.
  void solid(Place at, double z) {
    if (!gap_ && !points_.empty() && points_.back().at == at) return;
    add(at, z);
    gap_ = false;
  }
  /// There is no surface here.
  void gap(Place at) {
    if (gap_ && points_.back().at == at) return;
    add(at, std::nullopt);
    gap_ = true;
  }
  bool full() const { return points_.size() > most_; }
  std::vector<ProfilePoint> take() { return std::move(points_); }

 private:
  void add(Place at, std::optional<double> z) {
    double distance = 0;
    if (!points_.empty()) {
      const ProfilePoint& last = points_.back();
      distance = last.distance + (last.at == at ? 0 : ground_.distance(last.at, at));
    }
    points_.push_back({distance, at, z});
  }

  const frame::Ground& ground_;
  const std::size_t most_;
  std::vector<ProfilePoint> points_;
  bool gap_ = false;
};

class Profiler {
 public:
  Profiler(const terrain::Terrain& terrain, const VoidMask& voids, ProfileBuilder& builder)
      : mesh_(terrain.mesh()), voids_(voids), walk_(terrain), builder_(builder) {}

  void segment(Point p, Point q) {
    walk_.stations(p, q, stations_);
    if (stations_.empty() || stations_.front().along > 0) builder_.gap(frame::place(p));
    for (std::size_t i = 0; i < stations_.size() && !builder_.full(); ++i) {
      const Station& here = stations_[i];
      // Alone it has no triangle to ask about.
      if (stations_.size() == 1) station_alone(here);
      if (i + 1 < stations_.size()) piece(here, stations_[i + 1]);
    }
    if (stations_.empty() || stations_.back().along < 1) {
      if (!stations_.empty()) builder_.gap(stations_.back().at);
      builder_.gap(frame::place(q));
    }
  }

 private:
  bool may_be_void(const Station& station) const {
    return voids_.any() && station.to_next.value() != mesh::kNone &&
           voids_.may_touch(mesh_.triangle(station.to_next).vertices);
  }

  void station_alone(const Station& station) {
    const Point p{static_cast<std::int32_t>(station.at.x), static_cast<std::int32_t>(station.at.y)};
    if (may_be_void(station) && voids_.in_void_cell(p)) return builder_.gap(station.at);
    builder_.solid(station.at, station.z);
  }

  /// From one station to the next, in one triangle.
  void piece(const Station& from, const Station& to) {
    if (!may_be_void(from)) {
      builder_.solid(from.at, from.z);
      builder_.solid(to.at, to.z);
      return;
    }
    voids_.solid_parts(from.at, to.at, parts_);
    const auto at = [&](double part) {
      if (part == 0) return from.at;
      if (part == 1) return to.at;
      return Place{from.at.x + part * (to.at.x - from.at.x), from.at.y + part * (to.at.y - from.at.y)};
    };
    const auto z = [&](double part) { return part == 1 ? to.z : from.z + part * (to.z - from.z); };
    double reached = 0;
    for (const Interval& part : parts_) {
      if (part.from > reached) builder_.gap(at(reached));
      builder_.solid(at(part.from), z(part.from));
      builder_.solid(at(part.to), z(part.to));
      reached = part.to;
    }
    if (reached < 1) builder_.gap(at(reached));
  }

  const mesh::Mesh& mesh_;
  const VoidMask& voids_;
  SegmentWalk walk_;
  ProfileBuilder& builder_;
  std::vector<Station> stations_;
  std::vector<Interval> parts_;
};

}  // namespace

Result<std::vector<ProfilePoint>> profile(const terrain::Terrain& terrain, const frame::Ground& ground,
                                          std::span<const Point> line, Voids voids, std::size_t max_points) {
  if (line.empty()) return error(Code::kInvalidValue, "A line needs a position.");
  const VoidMask mask(terrain, voids);
  ProfileBuilder builder(ground, max_points);
  Profiler profiler(terrain, mask, builder);
  for (std::size_t i = 1; i < line.size() && !builder.full(); ++i) profiler.segment(line[i - 1], line[i]);
  if (line.size() == 1) profiler.segment(line[0], line[0]);
  if (builder.full()) {
    return error(Code::kTooLarge, "The profile would have more than " + std::to_string(max_points) +
                                      " points, the limit here.");
  }
  return builder.take();
}

}  // namespace tin::query
