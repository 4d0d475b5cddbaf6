// Edits as people ask for them, and changes as the journal keeps them.
#pragma once

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "tin/base/strong_id.h"
#include "tin/exact/point.h"

namespace tin::terrain {

/// A vertex's stable id: never used again after its removal; a revert brings it back. Starts at 1.
using VertexId = base::StrongId<struct VertexIdTag, std::uint64_t>;

/// Elevations lie within +-kMaxElevation, so that sums and products of a few of them stay finite, also as
/// floats.
inline constexpr double kMaxElevation = 1e30;

/// What to do when a vertex is inserted where one stands already.
enum class Duplicates { kReplace, kKeep, kMean, kMax, kMin, kReject };

struct Insert {
  exact::Point at;
  double z = 0;
};
struct Remove {
  VertexId id;
};
struct Move {
  VertexId id;
  exact::Point to;
};
struct SetZ {
  VertexId id;
  double z = 0;
};
using Edit = std::variant<Insert, Remove, Move, SetZ>;

/// A vertex without its id.
struct Placement {
  exact::Point at;
  double z = 0;
  friend bool operator==(const Placement&, const Placement&) = default;
};

/// One primitive set operation: nothing before means inserted, nothing after means removed, both mean
/// changed.
struct Step {
  VertexId id;
  std::optional<Placement> before;
  std::optional<Placement> after;
  friend bool operator==(const Step&, const Step&) = default;
};

/// Who made a change: it decides what the change does to the terrain's samples (amendments.h).
enum class Cause : std::uint8_t {
  kEdit,            // people: what they leave is the truth
  kRevert,          // a simplification is undone: an earlier state comes back
  kSimplification,  // vertices go or come as samples allow
  kUndo,            // an edit is undone: what it made the truth is so no longer
};

/// What an accepted edit really did, in order: the journal's record and the source of undo.
struct Change {
  std::vector<Step> steps;
  Cause cause = Cause::kEdit;
  friend bool operator==(const Change&, const Change&) = default;

  /// The change that undoes this one: steps reversed, before and after exchanged. Who undoes the undoing of an
  /// edit edits again, and so with simplifications.
  Change inverse() const;
};

}  // namespace tin::terrain
