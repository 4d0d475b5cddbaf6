// Rasters of the surface by scan conversion: triangle by triangle instead of pixel by pixel.
//
//   Rasteriser raster(terrain, {columns, rows}, {.voids = Voids::kKeep}, nodata);
//   for (std::size_t i = 0; i < rows.size(); ++i) raster.row(i, values);
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tin/frame/ground.h"
#include "tin/query/gradient.h"
#include "tin/query/voids.h"
#include "tin/terrain/terrain.h"

namespace tin::query {

/// Where the pixels of a raster have their centres: column i at lattice abscissa x[i], row j at lattice
/// ordinate y[j], for rasters whose rows and columns run along the lattice's axes. Each ascends or descends
/// (not necessarily strictly). Values beyond the lattice may be clamped to +-2^30: no terrain is there.
struct PixelCentres {
  std::vector<std::int32_t> x, y;
};

enum class RasterLayer {
  kElevation,  // in the vertical unit
  kSlope,      // degrees, 0 to 90
  kAspect,     // degrees clockwise from north; -1 on level ground
  kHillshade,  // 1 (in the shade) to 255, as gdaldem has it: 1 + 254 * Shade
};

/// What such a layer has for a gradient. Requires: not kElevation.
double layer_value(RasterLayer layer, Gradient g, const Shade& shade);

struct RasterOptions {
  RasterLayer layer = RasterLayer::kElevation;
  Voids voids = Voids::kKeep;
  Sun sun;                                // for kHillshade
  const frame::Ground* ground = nullptr;  // required but for kElevation
};

/// Values equal ElevationQuery::at() and GradientQuery::at() at each centre, bit for bit. Rows are made in
/// strips, so that memory is O(triangles + columns): two numbers per triangle and 16 MiB, or one row. Borrows
/// the terrain and ground. One thread.
class Rasteriser {
 public:
  /// `nodata` stands where there is no surface. Requires: no more than 2^31 rows and columns. Cost:
  /// O(triangles).
  Rasteriser(const terrain::Terrain& terrain, PixelCentres centres, const RasterOptions& options,
             double nodata);

  /// Fills `values`, one per column. Rows in ascending order cost O(pixels + triangles) in total; going back
  /// starts anew.
  void row(std::size_t row, std::span<double> values);

 private:
  /// Ordinates in ascending order, and the search of one by its likely place.
  class Ordinates {
   public:
    explicit Ordinates(const std::vector<std::int32_t>& values);
    std::size_t size() const { return values_.size(); }
    std::int32_t operator[](std::size_t i) const { return values_[i]; }
    bool reversed() const { return reversed_; }
    /// The first that is not below `bound`; size() when all are.
    std::size_t first_from(double bound) const;
    const double* doubles() const { return doubles_.data(); }

   private:
    std::vector<std::int32_t> values_;
    std::vector<double> doubles_;
    bool reversed_ = false;
    double per_step_ = 0;
  };
  struct Scan;

  void sort_into_strips();
  void sort_vertices_into_strips();
  std::size_t strip_of(std::size_t row) const;
  void make_strip(std::size_t strip);
  bool paint(mesh::TriangleSlot t);
  void cut(Scan& scan, std::size_t i, std::int32_t y, std::size_t& first, std::size_t& end) const;
  void paint_span(const Scan& scan, std::size_t row, std::size_t first, std::size_t end);
  void clear_voids(std::size_t row, std::size_t first, std::size_t end);
  void paint_vertex(mesh::VertexSlot v);
  void paint_line();
  double* at(std::size_t row, std::size_t column) {
    return strip_.data() + (row - strip_begin_) * x_.size() + column;
  }

  const terrain::Terrain& terrain_;
  const mesh::Mesh& mesh_;
  Ordinates x_, y_;
  const RasterLayer layer_;
  const Voids voids_mode_;
  const double nodata_;
  VoidMask voids_;
  const frame::Ground* ground_;
  std::optional<GradientQuery> gradient_;  // but for elevations
  Shade shade_;

  const std::size_t strip_rows_, strips_;
  // Triangles and vertices by the first strip, in the order of asking, that they may have a pixel in;
  // `begins` has one past the last as well. Rows are numbered by ascending y here.
  std::vector<std::size_t> triangle_begins_, vertex_begins_;
  std::vector<std::uint32_t> triangles_, vertices_;
  std::vector<std::uint32_t> active_;  // triangles that go on into the next strip
  std::size_t next_strip_ = 0;
  std::size_t strip_begin_ = 0, strip_end_ = 0;  // the rows in strip_
  std::vector<double> strip_;
  std::vector<frame::StepLengths> steps_;  // by row of the strip; for gradients
};

}  // namespace tin::query
