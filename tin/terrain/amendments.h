// What became of a terrain's samples since it was made: which of them people's edits put out of force, and
// which samples people made themselves.
//
// The rule: where people edit, the surface that they leave is the truth.
// - A vertex that they insert, move or give a height is a sample itself, with that height.
// - A sample of the source is out of force from then on when it stood where they inserted, moved, removed or
// set a
//   vertex, when it lies strictly inside the area whose triangles an edit made or bent, or when the terrain
//   no longer covers it.
// - What stands around such an area has to stay (rim()), or the surface inside would follow it.
// - What a simplification does changes no sample; neither does a revert, which only brings vertices back.
//
// On a terrain that still has all its samples as vertices no area matters, since no triangle holds a sample
// inside.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tin/exact/point.h"
#include "tin/terrain/edit.h"
#include "tin/terrain/source_samples.h"

namespace tin::terrain {

class Terrain;

/// What a terrain was made of.
enum class SourceKind : std::uint8_t {
  kNone,  // nothing is kept: its vertices are the samples, and those that simplifications took away
  kRaster,
  kPoints,
};

/// A triangle whose surface is an edit's. `inner` has bit i set when the area goes on beyond the edge
/// opposite to corner i.
struct EditedTriangle {
  std::array<exact::Point, 3> corners;  // counter-clockwise
  std::uint8_t inner = 0;
  friend bool operator==(const EditedTriangle&, const EditedTriangle&) = default;
};

class Amendments {
 public:
  Amendments() = default;
  explicit Amendments(SourceKind kind) : kind_(kind) {}
  /// From what the accessors gave. Requires: positions ascend, without repetition.
  Amendments(SourceKind kind, bool thinned, std::vector<exact::Point> touched,
             std::vector<EditedTriangle> areas, std::vector<Placement> own);

  SourceKind kind() const { return kind_; }
  /// Whether the terrain lacks some of its samples as vertices, so that areas of edits have to be remembered.
  bool thinned() const { return thinned_; }
  void set_thinned() { thinned_ = true; }
  /// Where people placed or removed vertices, ascending (of a raster's terrain: at pixel centres only).
  std::vector<exact::Point> touched() const;
  std::span<const EditedTriangle> areas() const { return areas_; }
  /// Samples beside the source's that are no vertices at present, or not with their own height; by position.
  std::span<const Placement> own() const { return own_; }
  /// Where people did not touch the corners of those areas, ascending: vertices there hold up the surface that
  /// an edit left, since they were linked to what people touched, or to each other where a vertex had gone.
  std::vector<exact::Point> rim(const Terrain& terrain) const;
  /// What the lists occupy: about 8 bytes per vertex that people touched, 150 if the terrain was simplified
  /// before.
  std::size_t bytes() const;

  /// Takes note of a change that `after` has taken in. Cost: O(log n) per step; on a thinned terrain its
  /// star's size.
  void take(const Terrain& after, const Change& change);

  /// The samples of `original` that are in force. Requires: `original` is what the terrain was made of; the
  /// terrain has dimension 2.
  SourceSamples in_force(const SourceSamples& original, const Terrain& terrain) const;

  friend bool operator==(const Amendments& a, const Amendments& b) {
    return a.kind_ == b.kind_ && a.thinned_ == b.thinned_ && a.touched() == b.touched() &&
           a.areas_ == b.areas_ && a.own_ == b.own_;
  }

 private:
  void take_edit(const Terrain& after, const Change& change);
  void take_simplification(const Terrain& after, const Change& change);
  bool is_off_pixels(const Terrain& terrain, exact::Point p) const;
  void add_touched(exact::Point p, const Terrain& terrain);
  void drop_own(const Terrain& after, std::span<const exact::Point> touched,
                std::span<const EditedTriangle> areas);

  SourceKind kind_ = SourceKind::kNone;
  bool thinned_ = false;
  std::vector<exact::Point>
      touched_;  // the first sorted_ of them ascend; later ones in any order, perhaps again
  std::size_t sorted_ = 0;
  std::vector<EditedTriangle> areas_;
  std::vector<Placement> own_;
};

/// The finite triangles of `after` that the change made, or bent by giving a corner another height. They
/// cover all of the surface that it changed, but for what the terrain no longer covers. Requires: `after` has
/// taken it in.
std::vector<EditedTriangle> edited_area(const Terrain& after, const Change& change);

}  // namespace tin::terrain
