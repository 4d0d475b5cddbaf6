// Samples at the cell centres of a raster, found by scan lines; the few that are elsewhere stand in a tree
// beside it.
#pragma once

#include <cstdint>
#include <memory_resource>
#include <optional>
#include <vector>

#include "tin/base/array.h"
#include "tin/simplify/block_scan.h"
#include "tin/simplify/point_samples.h"
#include "tin/simplify/samples.h"
#include "tin/terrain/source_grid.h"

namespace tin::simplify {

/// A sample at a cell's centre.
struct CellSample {
  std::int32_t column, row;
  double z;
};

/// Where a raster's heights lie, who may put an end to looking at them, and who notes what that takes (null:
/// nobody).
struct GridKeeping {
  std::pmr::memory_resource* memory;
  const base::Progress* progress;
  Footprint* footprint = nullptr;
};

/// What the two kinds of rasters share. Indices: row by row, then the samples off the raster.
class GridSamples : public Samples {
 public:
  Scan scan(const Site& a, const Site& b, const Site& c, double tolerance, Depth depth) const override;
  void narrow(const Site& a, const Site& b, const Site& c, double tolerance, Heights& heights) const override;
  Site site(SampleIndex sample) const override;
  void sites(SampleIndex begin, SampleIndex end, std::vector<Site>& out) const override;
  exact::Point position(SampleIndex sample) const override;
  std::optional<SampleIndex> find(exact::Point p) const override;
  SampleIndex end() const override { return others_.end(); }
  bool exists(SampleIndex sample) const override {
    return sample < cell_count() ? height(sample).has_value() : others_.exists(sample);
  }
  std::optional<Site> beside(const Site& sample, std::int32_t columns, std::int32_t rows) const override;
  bool has_neighbours() const override { return others_.empty(); }
  Footprint* footprint() const override { return footprint_; }
  Extent extent() const override;
  void outermost(const terrain::Box& box, std::vector<SampleIndex>& out) const override;

 protected:
  GridSamples(const terrain::SourceGrid& grid, std::vector<Facet::Corner> others, const GridKeeping& keeping);

  /// Scans the cells of a triangle whose corners are cell centres.
  virtual Scan scan_cells(const Site& a, const Site& b, const Site& c, double tolerance,
                          Depth depth) const = 0;
  /// What narrow() does, for corners that are cell centres.
  virtual void narrow_cells(const Site& a, const Site& b, const Site& c, double tolerance, Heights& heights) const = 0;
  /// The height of a cell's sample; NaN where there is none.
  virtual double height_or_nan(SampleIndex cell) const = 0;
  std::optional<double> height(SampleIndex cell) const {
    const double z = height_or_nan(cell);
    return z == z ? std::optional(z) : std::nullopt;
  }

  std::size_t cell_count() const {
    return static_cast<std::size_t>(grid_.width) * static_cast<std::size_t>(grid_.height);
  }
  SampleIndex index(std::int32_t column, std::int32_t row) const {
    return static_cast<SampleIndex>(row) * static_cast<SampleIndex>(grid_.width) +
           static_cast<SampleIndex>(column);
  }
  /// Asked once in many rows.
  bool cancelled(std::int32_t row) const { return row % 64 == 0 && cancelled(); }
  bool cancelled() const { return progress_ != nullptr && progress_->cancelled(); }
  const terrain::SourceGrid& grid() const { return grid_; }
  /// To be said after the cells between the rows and columns of these sites were looked at.
  void note_scan(const Site& a, const Site& b, const Site& c) const;
  const base::Pace& pace() const { return pace_; }
  virtual std::size_t bytes_per_cell() const = 0;

 private:
  Scan scan_between_cells(const Site& a, const Site& b, const Site& c, double tolerance, Depth depth) const;
  void narrow_between_cells(const Site& a, const Site& b, const Site& c, double tolerance, Heights& heights) const;
  template <class Visit>
  void visit_between_cells(const Site& a, const Site& b, const Site& c, const Visit& visit) const;

  const terrain::SourceGrid& grid_;
  PointSamples others_;
  const base::Progress* progress_;
  Footprint* footprint_;
  base::Pace pace_;  // of the heights' memory
};

/// Heights that are whole multiples of 2^-shift: scans take integers only and are exact by themselves.
class WholeGridSamples final : public GridSamples {
 public:
  /// Whether integers are wide enough for such heights of samples and corners, of absolute values up to `largest`.
  static bool can_hold(const terrain::SourceGrid& grid, int shift, double largest);

  /// Requires: can_hold(). May be without cells when cancelled: ask before putting any.
  WholeGridSamples(const terrain::SourceGrid& grid, int shift, double largest, bool any_height,
                   std::vector<Facet::Corner> others, const GridKeeping& keeping);
  void put(const CellSample& sample) {
    const auto z = static_cast<std::int32_t>(whole(sample.z));
    heights_[index(sample.column, sample.row)] = z;
    blocks_.put(sample.column, sample.row, z);
  }
  double fineness() const override { return 1 / scale_; }
  double most() const override { return largest_ / scale_; }

 private:
  static constexpr int kMostShift = 16;
  static constexpr double kMostHeight = 0x1p+30;

  std::int64_t whole(double z) const { return static_cast<std::int64_t>(z * scale_); }
  Scan scan_cells(const Site& a, const Site& b, const Site& c, double tolerance, Depth depth) const override;
  void narrow_cells(const Site& a, const Site& b, const Site& c, double tolerance, Heights& heights) const override;
  double height_or_nan(SampleIndex cell) const override;
  std::size_t bytes_per_cell() const override { return sizeof(std::int32_t); }

  int shift_;
  double scale_, largest_;  // 2^shift; the largest absolute height of a sample or corner, times that
  bool any_height_;         // corners need not be samples
  base::Array<std::int32_t> heights_;
  Blocks blocks_;
};

/// Any heights: scans take doubles, and doubtful cells are judged exactly.
class RealGridSamples final : public GridSamples {
 public:
  /// Whether no intermediate result of a scan overflows.
  static bool can_hold(double largest) { return largest <= kMostHeight; }
  double most() const override { return kMostHeight; }

  /// Requires: can_hold(). May be without cells when cancelled: ask before putting any.
  RealGridSamples(const terrain::SourceGrid& grid, std::vector<Facet::Corner> others,
                  const GridKeeping& keeping);
  void put(const CellSample& sample) { heights_[index(sample.column, sample.row)] = sample.z; }

 private:
  static constexpr double kMostHeight = 0x1p+400;

  Scan scan_cells(const Site& a, const Site& b, const Site& c, double tolerance, Depth depth) const override;
  void narrow_cells(const Site& a, const Site& b, const Site& c, double tolerance, Heights& heights) const override;
  Scan judge_all(const Site& a, const Site& b, const Site& c, double tolerance) const;
  double height_or_nan(SampleIndex cell) const override;
  std::size_t bytes_per_cell() const override { return sizeof(double); }

  base::Array<double> heights_;  // NaN: no sample
};

}  // namespace tin::simplify
