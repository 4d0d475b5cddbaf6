#include "tin/simplify/samples.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#include "tin/simplify/grid_samples.h"
#include "tin/simplify/point_samples.h"

namespace tin::simplify {

using mesh::VertexSlot;
using terrain::SourceGrid;
using terrain::Terrain;

namespace {

/// What decides how samples are kept.
struct Survey {
  std::size_t on_cells = 0, others = 0;
  double largest = 0;  // of the absolute heights
  int shift = 0;       // all heights are whole multiples of 2^-shift
};

/// The least s >= 0 such that z is a whole multiple of 2^-s.
int fraction_bits(double z) {
  if (z == std::trunc(z)) return 0;
  int exponent = 0;
  const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(z, &exponent), 53));
  return std::max(0, 53 - exponent - std::countr_zero(static_cast<std::uint64_t>(mantissa)));
}

/// Calls visit(position, height) for each vertex; false when cancelled.
template <class Visit>
bool visit_vertices(const Terrain& source, const base::Progress* progress, const Visit& visit) {
  for (std::uint32_t i = 1; i < source.mesh().vertex_slots(); ++i) {
    if (i % 16384 == 0 && progress != nullptr && progress->cancelled()) return false;
    if (source.mesh().is_alive(VertexSlot(i)))
      visit(source.mesh().point(VertexSlot(i)), source.z(VertexSlot(i)));
  }
  return progress == nullptr || !progress->cancelled();
}

std::optional<Survey> survey(const Terrain& source, const base::Progress* progress) {
  Survey out;
  const SourceGrid* const grid = source.source_grid();
  const bool finished = visit_vertices(source, progress, [&](exact::Point p, double z) {
    ++(grid != nullptr && grid->cell_centred_at(p) ? out.on_cells : out.others);
    out.largest = std::max(out.largest, std::abs(z));
    out.shift = std::max(out.shift, fraction_bits(z));
  });
  if (!finished) return std::nullopt;
  return out;
}

/// A raster that few samples are left of is not worth scanning cell by cell.
bool is_worth_scanning(const SourceGrid& grid, const Survey& found) {
  const double cells = static_cast<double>(grid.width) * grid.height;
  return found.on_cells > found.others && cells <= 16.0 * static_cast<double>(found.on_cells) &&
         cells + static_cast<double>(found.others) < 0x1p+32;
}

std::vector<Facet::Corner> all_points(const Terrain& source, const SourceGrid* except_on, std::size_t count) {
  std::vector<Facet::Corner> out;
  out.reserve(count);
  visit_vertices(source, nullptr, [&](exact::Point p, double z) {
    if (except_on == nullptr || !except_on->cell_centred_at(p)) out.push_back({p, z});
  });
  return out;
}

template <class Grid>
std::unique_ptr<Samples> filled(std::unique_ptr<Grid> grid, const Terrain& source,
                                const base::Progress* progress) {
  const bool finished = visit_vertices(source, progress, [&](exact::Point p, double z) {
    if (const auto cell = source.source_grid()->cell_centred_at(p)) grid->put({cell->column, cell->row, z});
  });
  return finished ? std::move(grid) : nullptr;
}

}  // namespace

std::unique_ptr<Samples> make_samples(const Terrain& source, base::Progress* progress) {
  const auto found = survey(source, progress);
  if (!found) return nullptr;
  const SourceGrid* const grid = source.source_grid();
  if (grid != nullptr && is_worth_scanning(*grid, *found)) {
    auto others = found->others == 0 ? std::vector<Facet::Corner>() : all_points(source, grid, found->others);
    if (WholeGridSamples::can_hold(*grid, found->shift, found->largest)) {
      return filled(std::make_unique<WholeGridSamples>(*grid, found->shift, std::move(others), progress),
                    source, progress);
    }
    if (RealGridSamples::can_hold(found->largest)) {
      return filled(std::make_unique<RealGridSamples>(*grid, std::move(others), progress), source, progress);
    }
  }
  auto points =
      std::make_unique<PointSamples>(all_points(source, nullptr, source.vertex_count()), 0, progress);
  if (progress != nullptr && progress->cancelled()) return nullptr;
  return points;
}

}  // namespace tin::simplify
