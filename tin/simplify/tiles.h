// Dividing the ground among threads: rectangles of equal size, each worked on as a patch of its own. The division depends on
// the samples and on where it is told to begin, not on the number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "tin/simplify/patch.h"
#include "tin/simplify/phase.h"

namespace tin::simplify {

class Tiling {
 public:
  /// `columns` by `rows` tiles over the extent; moved by the fractions `shift_x` and `shift_y` of a tile (0..1), which adds
  /// a column and a row. Lines between tiles run through samples of a raster.
  Tiling(const Extent& extent, std::size_t columns, std::size_t rows, double shift_x = 0, double shift_y = 0);
  /// About `count` tiles that are nearly square.
  static Tiling of_about(const Extent& extent, std::size_t count, double shift_x = 0, double shift_y = 0);

  std::size_t size() const { return (xs_.size() - 1) * (ys_.size() - 1); }
  /// The tile's closed box: neighbours share the line between them.
  terrain::Box box(std::size_t tile) const;
  /// The tile that holds `p`; a line belongs to the tile after it.
  std::size_t tile_of(exact::Point p) const;
  /// Whether `p` lies in the tile's open box.
  bool is_inside(std::size_t tile, exact::Point p) const;

 private:
  std::vector<std::int64_t> xs_, ys_;  // ascending
};

/// Calls work(tile) once for each of 0..count-1, on up to `threads` threads, and reports what is done. False when cancelled.
bool for_each_tile(std::size_t count, unsigned threads, const Phase& phase, const std::function<void(std::size_t)>& work);

/// How many patches a TIN of so many vertices is best cut into.
std::size_t patch_count(std::size_t vertices);

/// Cuts the TIN into patches by `tiling`, calls work(patch, tile) for each, several at once, and puts together what they left.
/// False when cancelled; then `tin` is null. Requires: tin owns all its vertices.
bool work_in_patches(std::unique_ptr<Patch>& tin, const Tiling& tiling, unsigned threads, const Phase& phase,
                     const std::function<void(Patch&, std::size_t tile)>& work);

}  // namespace tin::simplify
