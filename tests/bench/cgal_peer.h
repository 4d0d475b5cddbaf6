// CGAL's triangulation behind a small interface, so that its headers are compiled once. Without CGAL (TINSMITH_BENCH_CGAL
// undefined) there is no peer.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "tin/exact/point.h"

namespace bench {

class CgalPeer {
 public:
  virtual ~CgalPeer() = default;
  /// All at once, in CGAL's own spatial order.
  virtual void build(std::span<const tin::exact::Point> points) = 0;
  /// One by one in the given order.
  virtual void insert(std::span<const tin::exact::Point> points) = 0;
  /// After build(): finds the vertex of each point, for remove(). Quick when neighbours in the list are near on the ground.
  virtual void remember(std::span<const tin::exact::Point> points) = 0;
  /// Removes the vertices of points[i] for each i in `order`.
  virtual void remove(std::span<const std::uint32_t> order) = 0;
  /// Locates each; returns how many lie inside or on the hull.
  virtual std::size_t locate(std::span<const tin::exact::Point> points) = 0;
  virtual std::size_t vertices() const = 0;
};

/// With the hierarchy (location, insertion one by one) or plain (bulk building, removal). nullptr without CGAL.
std::unique_ptr<CgalPeer> make_cgal_peer(bool with_hierarchy);

}  // namespace bench
