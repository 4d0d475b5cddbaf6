// What became of a terrain's samples since it was made: which of them people's edits put out of force, and
// which samples people made themselves.
//
// The rule: where people edit, the surface that they leave is the truth.
// - A vertex that they insert, move or give a height is a sample itself, with that height.
// - A sample of the source is out of force from then on when it stood where they inserted, moved, removed or set a
//   vertex, when it lies strictly inside the area whose triangles an edit made or bent, or when the terrain
//   no longer covers it, since an edit took vertices from its outline. So is a sample of people's, if it is older than that edit.
// - What stands around such an area has to stay (rim()), or the surface inside would follow it.
// - An edit that is undone has never been: what it alone put out of force is in force again, and its own samples are none.
//   Who undoes what does not stand (it was undone before, others came after, or it is not known any more) touches vertices, but
//   no area; who undoes the undoing of an edit edits again.
// - What a simplification does changes no sample, and its undoing changes none.
//
// So there is a list of the edits that stand, in their order, with the positions and triangles of each; what is in force follows
// from it when somebody asks. On a terrain that still has all its samples as vertices no triangle holds one inside.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tin/exact/point.h"
#include "tin/terrain/edit.h"
#include "tin/terrain/edited_area.h"
#include "tin/terrain/source_samples.h"

namespace tin::terrain {

class Terrain;

/// What a terrain was made of.
enum class SourceKind : std::uint8_t {
  kNone,  // nothing is kept: its vertices are the samples, and those that simplifications took away
  kRaster,
  kPoints,
};

/// An edit that stands. Their numbers ascend, and none is used again.
struct Deed {
  std::uint64_t number = 1;
  std::uint64_t fingerprint = 0;  // of its change
  std::uint64_t triangles = 0;    // of its area
  bool shrank = false;            // vertices left the outline
  friend bool operator==(const Deed&, const Deed&) = default;
};

/// Whose something is: the number of a deed; 0: of an edit that is not known, or nobody's.
using DeedNumber = std::uint64_t;

/// Where people placed or removed a vertex.
struct Touch {
  exact::Point at;
  DeedNumber deed = 0;
  friend bool operator==(const Touch&, const Touch&) = default;
};

/// A vertex that a simplification took away, or gave another height.
struct OwnSample {
  Placement sample;
  DeedNumber maker = 0;  // the last deed that had touched the position, or held it inside its area
  friend bool operator==(const OwnSample&, const OwnSample&) = default;
};

class Amendments {
 public:
  /// All there is to them.
  struct Parts {
    SourceKind kind = SourceKind::kNone;
    bool thinned = false;
    DeedNumber next_deed = 1;
    std::vector<Deed> deeds;
    std::vector<Touch> touches;         // by position, then deed
    std::vector<EditedTriangle> areas;  // first those of edits that are not known, then deed by deed
    std::vector<OwnSample> own;         // by position, then maker; none twice
    friend bool operator==(const Parts&, const Parts&) = default;
  };

  Amendments() = default;
  explicit Amendments(SourceKind kind) { parts_.kind = kind; }
  explicit Amendments(Parts parts) : parts_(std::move(parts)), sorted_(parts_.touches.size()) {}
  Parts parts() const;

  SourceKind kind() const { return parts_.kind; }
  /// Whether the terrain lacks some of its samples as vertices, so that areas of edits have to be remembered.
  bool thinned() const { return parts_.thinned; }
  void set_thinned() { parts_.thinned = true; }
  /// Where people placed or removed vertices, ascending.
  std::vector<exact::Point> touched() const;
  /// Of the edits that stand.
  std::span<const EditedTriangle> areas() const { return parts_.areas; }
  /// Where people did not touch the corners of those areas, ascending: vertices there hold up the surface that
  /// an edit left, since they were linked to what people touched, or to each other where a vertex had gone.
  std::vector<exact::Point> rim(const Terrain& terrain) const;
  /// What the lists occupy: about 24 bytes per edit, 16 per vertex that it touched, and 170 if the terrain was simplified before.
  std::size_t bytes() const;

  /// Takes note of a change that `after` has taken in. Cost: O(log n) per step; on a thinned terrain its star's size; to undo an
  /// edit, linear in what is noted.
  void take(const Terrain& after, const Change& change);

  /// The samples of `original` that are in force. Requires: `original` is what the terrain was made of. Cost: that of copying the
  /// mask, and of looking at what edits touched; for points linear.
  SourceSamples in_force(const SourceSamples& original, const Terrain& terrain) const;
  /// Samples in force beside the source's, by position: vertices that simplifications took away or gave another height, where there
  /// is no source, or where people had edited. Shares no position with in_force(). Cost: linear in what is noted.
  std::vector<Placement> own_in_force(const Terrain& terrain) const;

  friend bool operator==(const Amendments& a, const Amendments& b) { return a.parts() == b.parts(); }

 private:
  Deed* take_touches(std::span<const Step> net, std::uint64_t print);
  void take_edit(const Terrain& after, const Change& change);
  void take_simplification(const Terrain& after, const Change& change);
  bool forget(const Change& edit);
  void forget_names();
  std::vector<std::optional<DeedNumber>> last_deeds(std::span<const exact::Point> positions,
                                                    std::span<const Touch> all_touches, DeedNumber last) const;
  bool may_have_shrunk() const;
  std::vector<bool> overruled(std::span<const Touch> all_touches, DeedNumber last) const;
  bool is_off_pixels(const Terrain& terrain, exact::Point p) const;
  std::vector<Touch> touches() const;

  Parts parts_;  // of its touches the first sorted_ ascend; later ones come in any order
  std::size_t sorted_ = 0;
};

}  // namespace tin::terrain
