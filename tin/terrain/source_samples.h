// All samples that a terrain was made of, kept when vertices are taken away: what a simplification is certified
// against, however often the terrain was simplified before.
//
//   auto source = SourceSamples::raster(grid, heights);      // NaN: no sample
//   source.z(*source.find(p));                               // the very double that came in
//   auto rest = source.without(touched);                     // people's edits stand in their place now
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <memory_resource>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "tin/base/array.h"
#include "tin/exact/point.h"
#include "tin/terrain/edit.h"
#include "tin/terrain/source_grid.h"

namespace tin::terrain {

/// Immutable; copies share the heights. A sample is named by its index: row * width + column in a raster, else its
/// rank among the points, sorted by position.
class SourceSamples {
 public:
  /// Heights in the narrowest form that keeps each of them bit for bit, in memory of the maker's choice, which must outlive them.
  /// Integers are multiples of 2^-shift.
  struct Heights {
    std::variant<base::Array<std::int16_t>, base::Array<std::int32_t>, base::Array<float>, base::Array<double>>
        stored;
    int shift = 0;

    double at(std::size_t i) const;
    std::size_t size() const;
    std::pmr::memory_resource* memory() const;
    std::size_t bytes_each() const;
  };

  /// Requires: heights.size() == width * height, below 2^32; each finite, or NaN where there is no sample. Cells that the
  /// grid says are void are none either.
  static SourceSamples raster(std::shared_ptr<const SourceGrid> grid, std::span<const double> heights);
  /// Requires: distinct positions, finite heights; fewer than 2^32.
  static SourceSamples points(std::vector<Placement> points);
  /// From what raster(), valid() and heights() gave: a stored one. Requires: sizes that fit.
  static SourceSamples restored_raster(std::shared_ptr<const SourceGrid> grid, Heights heights,
                                       std::vector<std::uint64_t> valid);
  /// The same for points. Requires: positions ascend; one height each.
  static SourceSamples restored_points(std::vector<exact::Point> positions, Heights heights);

  bool is_raster() const { return grid_ != nullptr; }
  /// Null unless a raster.
  const std::shared_ptr<const SourceGrid>& grid() const { return grid_; }
  const Heights& heights() const { return *heights_; }
  /// Of points, ascending; none in a raster.
  std::span<const exact::Point> positions() const {
    return points_ ? std::span<const exact::Point>(*points_) : std::span<const exact::Point>();
  }
  /// One bit per index, 1 = a sample; empty when all are.
  std::span<const std::uint64_t> valid() const { return valid_; }

  /// One past the largest index.
  std::size_t size() const { return heights_->size(); }
  /// How many of them are samples.
  std::size_t sample_count() const { return count_; }
  bool is_sample(std::size_t i) const { return valid_.empty() || ((valid_[i / 64] >> (i % 64)) & 1U) != 0; }
  exact::Point at(std::size_t i) const;
  double z(std::size_t i) const { return heights_->at(i); }
  /// The sample at `p`; nothing where there is none. Cost: O(1) in a raster, else O(log n).
  std::optional<std::size_t> find(exact::Point p) const;

  /// The same without these samples, whose heights are kept but no longer count.
  SourceSamples without(std::span<const std::size_t> samples) const;

 private:
  void count();

  std::shared_ptr<const SourceGrid> grid_;
  std::shared_ptr<const std::vector<exact::Point>> points_;  // ascending; null in a raster
  std::shared_ptr<const Heights> heights_;
  std::vector<std::uint64_t> valid_;
  std::size_t count_ = 0;
};

}  // namespace tin::terrain
