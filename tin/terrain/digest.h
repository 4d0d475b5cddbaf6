// The digest: a hash of a terrain's content that does not depend on its history; and one of a change.
#pragma once

#include <cstdint>
#include <string>

#include "tin/exact/point.h"
#include "tin/frame/frame.h"
#include "tin/terrain/edit.h"

namespace tin::terrain {

/// A commutative hash of a set of vertices: the sum, modulo 2^128 in two lanes, of a hash of each vertex. Adding and
/// taking away a vertex costs O(1), so that the digest of every revision is at hand. Equal sets give equal
/// digests; it guards against accidents, not against people who craft collisions.
class VertexSetHash {
 public:
  void add(exact::Point at, double z);
  void subtract(exact::Point at, double z);
  /// 32 hexadecimal digits over the set, its size and the frame.
  std::string digest(const frame::Frame& frame) const;
  friend bool operator==(const VertexSetHash&, const VertexSetHash&) = default;

 private:
  std::uint64_t low_ = 0;
  std::uint64_t high_ = 0;
  std::uint64_t count_ = 0;
};

/// By which a change is known again: a hash of its steps, in order. Never 0. Cost: O(steps).
std::uint64_t fingerprint(const Change& change);

}  // namespace tin::terrain
