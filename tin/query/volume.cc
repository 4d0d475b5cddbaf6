#include "tin/query/volume.h"

#include <algorithm>
#include <cmath>

#include "tin/query/measure.h"
#include "tin/query/pieces.h"

namespace tin::query {

using base::Result;
using mesh::TriangleSlot;

namespace {

/// More than the square metres of the terrain's bounding box.
double area_bound(const terrain::Terrain& terrain, const frame::Ground& ground) {
  const auto box = terrain.bounds();
  if (!box) return 1;
  const double equator = std::clamp(terrain.frame().y.lattice(0), double(box->min.y), double(box->max.y));
  const double largest =
      std::max({ground.area_at(box->min.y), ground.area_at(box->max.y), ground.area_at(equator)});
  return 2 * largest * (double(box->max.x) - box->min.x + 1) * (double(box->max.y) - box->min.y + 1) + 1;
}

double z_bound(const terrain::Terrain& terrain) {
  const auto range = terrain.z_range();
  return range ? std::max(std::abs(range->min), std::abs(range->max)) + 1 : 1;
}

/// Sums of one side of something. With a region's holes partial sums may reach twice the whole.
struct Side {
  Side(double area, double height) : area_sum(4 * area), volume_sum(4 * area * height) {}
  void add(const Integral& part, double sign) {
    area_sum.add(sign * part.area);
    volume_sum.add(sign * part.value);
  }
  double area() const { return std::max(0.0, area_sum.value()); }
  double volume() const { return std::max(0.0, volume_sum.value()); }

  FixedSum area_sum, volume_sum;
};

}  // namespace

Result<LevelVolumes> volumes_at(const terrain::Terrain& terrain, const frame::Ground& ground, double level,
                                const Where& where, base::Progress* progress) {
  const double area = area_bound(terrain, ground), height = z_bound(terrain) + std::abs(level);
  Side above(area, height), below(area, height);
  const auto done =
      Pieces(terrain, where.region, where.voids, progress)
          .each([&](TriangleSlot t, const Facet& facet, const Convex& piece, double sign) {
            const auto& v = terrain.mesh().triangle(t).vertices;
            const auto [low, high] = std::minmax({terrain.z(v[0]), terrain.z(v[1]), terrain.z(v[2])});
            const Plane plane = facet.plane();
            const auto over = [&](Place p) { return plane(p) - level; };
            const auto under = [&](Place p) { return level - plane(p); };
            if (low >= level) return above.add(integrate(ground, piece, over), sign);
            if (high < level) return below.add(integrate(ground, piece, under), sign);
            above.add(integrate(ground, clip(piece, over), over), sign);
            below.add(integrate(ground, clip(piece, under), under), sign);
          });
  if (!done) return done.error();
  const double metres = ground.vertical_m();
  return LevelVolumes{above.area(), below.area(), above.volume() * metres, below.volume() * metres};
}

Result<SurfaceArea> surface_area(const terrain::Terrain& terrain, const frame::Ground& ground,
                                 const Where& where, base::Progress* progress) {
  // A facet's surface has no bound but its steepness: that of a rise over the least distance of two vertices.
  const frame::StepLengths step = ground.steps_at(terrain.frame().y.lattice(89));
  const double steepest = 1 + 2 * z_bound(terrain) * ground.vertical_m() / std::min(step.x, step.y);
  Side sum(area_bound(terrain, ground), 2 * steepest);
  const auto done =
      Pieces(terrain, where.region, where.voids, progress)
          .each([&](TriangleSlot, const Facet& facet, const Convex& piece, double sign) {
            const double x = facet.dz_dx() * ground.vertical_m(), y = facet.dz_dy() * ground.vertical_m();
            const auto stretch = [&](Place p) {
              const frame::StepLengths metres = ground.steps_at(p.y);
              return std::sqrt(1 + x / metres.x * (x / metres.x) + y / metres.y * (y / metres.y));
            };
            sum.add(integrate(ground, piece, stretch), sign);
          });
  if (!done) return done.error();
  return SurfaceArea{sum.area(), sum.volume()};
}

namespace {

/// The lattice of one frame in steps of another's.
class Across {
 public:
  Across(const frame::Frame& from, const frame::Frame& to)
      : from_(from), to_(to), same_(from.x == to.x && from.y == to.y) {}
  Place operator()(Place p) const {
    if (same_) return p;
    return {to_.x.lattice(from_.x.world(p.x)), to_.y.lattice(from_.y.world(p.y))};
  }
  Convex operator()(Convex polygon) const {
    for (std::size_t i = 0; i < polygon.size; ++i) polygon.corners[i] = (*this)(polygon.corners[i]);
    return polygon;
  }

 private:
  const frame::Frame &from_, &to_;
  bool same_;
};

/// The second terrain under the pieces of the first.
class Overlay {
 public:
  Overlay(const terrain::Terrain& before, const terrain::Terrain& after, const frame::Ground& ground,
          Voids voids)
      : after_(after),
        ground_(ground),
        to_after_(before.frame(), after.frame()),
        to_before_(after.frame(), before.frame()),
        before_m_(before.frame().vertical_unit_m),
        after_m_(after.frame().vertical_unit_m),
        height_(z_bound(before) * before_m_ + z_bound(after) * after_m_),
        voids_(after, voids),
        flood_(after),
        cut_(area_bound(before, ground), height_),
        fill_(cut_),
        equal_(cut_) {}

  void piece(const Facet& facet, const Convex& piece, double sign) {
    for (std::size_t i = 2; i < piece.size; ++i) {
      meet(facet.plane(), triangle(piece.corners[0], piece.corners[i - 1], piece.corners[i]), sign);
    }
  }

  CutFill result() const { return {cut_.area(), fill_.area(), equal_.area(), cut_.volume(), fill_.volume()}; }

 private:
  void meet(const Plane& before, const Convex& part, double sign) {
    const Convex there = to_after_(part);
    flood_.visit(there.corners[0], there.corners[1], there.corners[2], [&](TriangleSlot t) {
      const Slots corners = canonical_corners(after_.mesh(), t);
      const Facet other(after_, corners);
      const Convex common =
          clip_to_triangle(part, to_before_(frame::place(other.a())), to_before_(frame::place(other.b())),
                           to_before_(frame::place(other.c())));
      if (common.empty()) return;
      const Plane after = other.plane();
      if (!voids_.may_touch(corners)) return compare(before, after, common, sign);
      voids_.solid_parts(to_after_(common), parts_);
      for (const Convex& solid : parts_) compare(before, after, to_before_(solid), sign);
    });
  }

  void compare(const Plane& before, const Plane& after, const Convex& common, double sign) {
    double least = 0, most = 0;
    const auto rise = [&](Place p) { return after(to_after_(p)) * after_m_ - before(p) * before_m_; };
    for (const Place& p : common) {
      least = std::min(least, rise(p));
      most = std::max(most, rise(p));
    }
    const double same = 1e-12 * height_;
    if (least >= -same && most <= same)
      return equal_.add(integrate(ground_, common, [](Place) { return 0.0; }), sign);
    const auto fall = [&](Place p) { return -rise(p); };
    if (most > same) fill_.add(integrate(ground_, least < 0 ? clip(common, rise) : common, rise), sign);
    if (least < -same) cut_.add(integrate(ground_, most > 0 ? clip(common, fall) : common, fall), sign);
  }

  const terrain::Terrain& after_;
  const frame::Ground& ground_;
  const Across to_after_, to_before_;
  const double before_m_, after_m_, height_;
  VoidMask voids_;
  Flood flood_;
  Side cut_, fill_, equal_;
  std::vector<Convex> parts_;
};

}  // namespace

Result<CutFill> cut_fill(const terrain::Terrain& before, const terrain::Terrain& after,
                         const frame::Ground& ground, const Where& where, base::Progress* progress) {
  if (before.frame().crs != after.frame().crs) {
    return base::error(base::Code::kInvalidValue, "The two TINs are in different CRSs.");
  }
  Overlay overlay(before, after, ground, where.voids);
  const auto done = Pieces(before, where.region, where.voids, progress)
                        .each([&](TriangleSlot, const Facet& facet, const Convex& piece, double sign) {
                          overlay.piece(facet, piece, sign);
                        });
  if (!done) return done.error();
  return overlay.result();
}

}  // namespace tin::query
