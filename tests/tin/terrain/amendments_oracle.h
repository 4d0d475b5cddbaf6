// What is in force of a terrain's samples, by the words of the rule: an oracle that compares the surface before and after each
// edit, triangle by triangle.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "tin/exact/point.h"
#include "tin/exact/predicates.h"
#include "tin/terrain/edit.h"
#include "tin/terrain/terrain.h"

namespace tests::terrain {

using tin::exact::orientation;
using tin::exact::Point;
using tin::mesh::TriangleSlot;
using tin::terrain::Change;
using tin::terrain::Step;
using tin::terrain::Terrain;
using tin::terrain::VertexId;

using Corner = std::pair<Point, double>;
using Facet = std::array<Corner, 3>;   // sorted
using Border = std::array<Corner, 2>;  // sorted

struct Surface {
  std::set<Facet> facets;
  std::set<Border> borders;

  explicit Surface(const Terrain& t) {
    const auto& mesh = t.mesh();
    if (mesh.dimension() < 2) return;
    for (std::uint32_t i = 0; i < mesh.triangle_slots(); ++i) {
      if (!mesh.is_alive(TriangleSlot(i))) continue;
      std::vector<Corner> corners;
      for (const auto v : mesh.triangle(TriangleSlot(i)).vertices) {
        if (v != tin::mesh::kInfinite) corners.emplace_back(mesh.point(v), t.z(v));
      }
      std::sort(corners.begin(), corners.end());
      if (corners.size() == 3) {
        facets.insert({corners[0], corners[1], corners[2]});
      } else {
        borders.insert({corners[0], corners[1]});
      }
    }
  }
};

inline bool holds(const Facet& f, Point p) {
  std::array<Point, 3> c{f[0].first, f[1].first, f[2].first};
  if (orientation(c[0], c[1], c[2]) < 0) std::swap(c[1], c[2]);
  return orientation(c[0], c[1], p) >= 0 && orientation(c[1], c[2], p) >= 0 &&
         orientation(c[2], c[0], p) >= 0;
}

inline bool holds(const Border& b, Point p) {
  return orientation(b[0].first, b[1].first, p) == 0 && b[0].first < p && p < b[1].first;
}

/// What an edit did to the samples that there were.
struct Followed {
  std::vector<Step> steps;
  std::set<Point> touched;
  std::map<Point, double> made;  // samples
  std::set<Point> inside;        // of its area
  bool shrank = false;           // vertices left the outline
};

/// Follows edits by the words of the rule. `nobodys` are samples that are older than all edits.
class Oracle {
 public:
  explicit Oracle(std::map<Point, double> nobodys) : nobodys_(std::move(nobodys)) {}

  void edit(const Surface& before, const Surface& after, const Change& change, bool has_area = true) {
    std::map<VertexId, Step> net;
    for (const Step& step : change.steps) net.try_emplace(step.id, step).first->second.after = step.after;
    Followed edit{change.steps, {}, {}, {}, false};
    for (const auto& [id, step] : net) {
      if (step.before == step.after) continue;
      if (step.before) edit.touched.insert(step.before->at);
      if (step.after) edit.touched.insert(step.after->at);
    }
    if (edit.touched.empty()) return;
    for (const auto& [id, step] : net) {
      const bool left = step.before && (!step.after || step.after->at != step.before->at);
      edit.shrank |= has_area && left && !is_covered(step.before->at, after);
    }
    for (const auto& [id, step] : net) {
      if (step.before != step.after && step.after) edit.made[step.after->at] = step.after->z;
    }
    std::set<Point> corners;
    for (const Facet& f : after.facets) {
      for (const Corner& c : f) corners.insert(c.first);
    }
    for (const auto& [p, z] : nobodys_) {
      if (has_area && lies_inside(p, edit, corners, before, after)) edit.inside.insert(p);
    }
    for (const Followed& earlier : standing_) {
      for (const auto& [p, z] : earlier.made) {
        if (has_area && lies_inside(p, edit, corners, before, after)) edit.inside.insert(p);
      }
    }
    standing_.push_back(std::move(edit));
  }

  /// Undone, if it stands, and is the last that touched its positions; else what undoes it is an edit.
  void undo(const Surface& before, const Surface& after, const Change& change) {
    const auto steps = change.inverse().steps;
    const auto found = std::find_if(standing_.rbegin(), standing_.rend(),
                                    [&](const Followed& edit) { return edit.steps == steps; });
    if (found == standing_.rend()) return edit(before, after, change, false);
    const bool is_last = std::none_of(standing_.rbegin(), found, [&](const Followed& later) {
      return std::any_of(later.touched.begin(), later.touched.end(),
                         [&](Point p) { return found->touched.contains(p); });
    });
    if (!is_last) return edit(before, after, change, false);
    standing_.erase(std::next(found).base());
  }

  /// What it takes away, or gives another height, stays a sample where there was none: since an edit had put it out of force.
  void simplification(const Change& change) {
    for (const Step& step : change.steps) {
      if (!step.before) continue;
      const Point p = step.before->at;
      const auto last = std::find_if(standing_.rbegin(), standing_.rend(), [p](const Followed& edit) {
        return edit.touched.contains(p) || edit.inside.contains(p);
      });
      if (last != standing_.rend()) last->made.emplace(p, step.before->z);
    }
  }

  std::set<Point> nobodys_in_force(const Surface& now) const {
    std::set<Point> out;
    for (const auto& [p, z] : nobodys_) {
      if (is_in_force(p, 0, now)) out.insert(p);
    }
    return out;
  }

  std::map<Point, double> peoples_in_force(const Surface& now) const {
    std::map<Point, double> out;
    for (std::size_t i = 0; i < standing_.size(); ++i) {
      for (const auto& [p, z] : standing_[i].made) {
        if (is_in_force(p, i + 1, now)) out[p] = z;
      }
    }
    return out;
  }

 private:
  bool is_in_force(Point p, std::size_t next, const Surface& now) const {
    for (; next < standing_.size(); ++next) {
      if (standing_[next].touched.contains(p) || standing_[next].inside.contains(p)) return false;
    }
    const auto shrank = [](const Followed& edit) { return edit.shrank; };
    return std::none_of(standing_.begin(), standing_.end(), shrank) || is_covered(p, now);
  }

  static bool is_covered(Point p, const Surface& now) {
    return std::any_of(now.facets.begin(), now.facets.end(), [p](const Facet& f) { return holds(f, p); });
  }

  /// In the inside of what is otherwise than before, or has a corner that was made.
  static bool lies_inside(Point p, const Followed& edit, const std::set<Point>& corners, const Surface& before,
                          const Surface& after) {
    const auto is_made = [&](const Corner& c) { return edit.made.contains(c.first); };
    bool covered = false;
    for (const Facet& f : after.facets) {
      if (!holds(f, p)) continue;
      const bool is_old = before.facets.contains(f) && std::none_of(f.begin(), f.end(), is_made);
      if (corners.contains(p) || is_old) return false;
      covered = true;
    }
    return covered && std::none_of(after.borders.begin(), after.borders.end(), [&](const Border& b) {
             return holds(b, p) && before.borders.contains(b) && std::none_of(b.begin(), b.end(), is_made);
           });
  }

  std::map<Point, double> nobodys_;
  std::vector<Followed> standing_;
};

}  // namespace tests::terrain
