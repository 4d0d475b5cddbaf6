#include "tin/simplify/samples.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#include "tin/exact/predicates.h"
#include "tin/simplify/grid_samples.h"
#include "tin/simplify/plateaus.h"
#include "tin/simplify/point_samples.h"
#include "tin/simplify/source_mesh.h"
#include "tin/simplify/spans.h"
#include "tin/simplify/surface_samples.h"

namespace tin::simplify {

using mesh::VertexSlot;
using exact::Point;
using terrain::Placement;
using terrain::SourceGrid;
using terrain::SourceSamples;
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

constexpr std::size_t kOften = 16384;  // samples between two questions whether to go on

bool is_cancelled(const base::Progress* progress) {
  return progress != nullptr && progress->cancelled();
}

/// What samples are made of: all of a source, people's own, then the vertices where neither has one.
class Input {
 public:
  Input(const Terrain* terrain, const SourceSamples* source, std::span<const Placement> own)
      : terrain_(terrain), source_(source), others_(own.begin(), own.end()) {
    const auto is_own = [own](Point p) {
      const auto at = std::lower_bound(own.begin(), own.end(), p, [](const Placement& a, Point b) { return a.at < b; });
      return at != own.end() && at->at == p;
    };
    if (terrain_ == nullptr || are_vertices()) return;
    visit_vertices(nullptr, [&](Point p, double z) {
      if (!(source_ != nullptr && source_->find(p)) && !is_own(p)) others_.push_back({p, z});
    });
  }

  const SourceGrid* grid() const {
    if (source_ != nullptr) return source_->grid().get();
    return terrain_->source_grid();
  }

  /// Calls visit(cell) for each sample at a cell's centre and off_grid(position, height) for all others; false when cancelled.
  template <class Visit, class OffGrid>
  bool visit(const base::Progress* progress, const Visit& visit, const OffGrid& off_grid) const {
    const SourceGrid* const grid = this->grid();
    const auto sort = [&](Point p, double z) {
      const auto cell = grid == nullptr ? std::nullopt : grid->cell_centred_at(p);
      cell ? visit(CellSample{cell->column, cell->row, z}) : off_grid(p, z);
    };
    if (are_vertices()) return visit_vertices(progress, sort);
    if (source_ != nullptr && !visit_source(progress, visit, sort)) return false;
    for (std::size_t i = 0; i < others_.size(); ++i) {
      if (i % kOften == 0 && is_cancelled(progress)) return false;
      sort(others_[i].at, others_[i].z);
    }
    return !is_cancelled(progress);
  }

 private:
  /// Nothing but the vertices: they need not be copied.
  bool are_vertices() const { return source_ == nullptr && others_.empty(); }

  /// A raster's cells are known by where they are, which matters where there are hundreds of millions.
  template <class Visit, class Sort>
  bool visit_source(const base::Progress* progress, const Visit& visit, const Sort& sort) const {
    if (!source_->is_raster()) {
      for (std::size_t i = 0; i < source_->size(); ++i) {
        if (i % kOften == 0 && is_cancelled(progress)) return false;
        if (source_->is_sample(i)) sort(source_->at(i), source_->z(i));
      }
      return true;
    }
    const base::Pace pace(source_->heights().memory());
    const std::size_t row_bytes =
        static_cast<std::size_t>(source_->grid()->width) * source_->heights().bytes_each();
    std::size_t i = 0;
    for (std::int32_t row = 0; row < source_->grid()->height; ++row) {
      if (is_cancelled(progress)) return false;
      pace.touched(1, row_bytes);
      for (std::int32_t column = 0; column < source_->grid()->width; ++column, ++i) {
        if (source_->is_sample(i)) visit(CellSample{column, row, source_->z(i)});
      }
    }
    return true;
  }

  template <class Visit>
  bool visit_vertices(const base::Progress* progress, const Visit& visit) const {
    const mesh::Mesh& mesh = terrain_->mesh();
    for (std::uint32_t i = 1; i < mesh.vertex_slots(); ++i) {
      if (i % kOften == 0 && is_cancelled(progress)) return false;
      if (mesh.is_alive(VertexSlot(i))) visit(mesh.point(VertexSlot(i)), terrain_->z(VertexSlot(i)));
    }
    return !is_cancelled(progress);
  }

  const Terrain* terrain_;
  const SourceSamples* source_;
  std::vector<Placement> others_;
};

std::optional<Survey> survey(const Input& input, const base::Progress* progress) {
  Survey out;
  const auto look_at = [&out](double z) {
    out.largest = std::max(out.largest, std::abs(z));
    out.shift = std::max(out.shift, fraction_bits(z));
  };
  const bool finished = input.visit(
      progress,
      [&](const CellSample& cell) {
        ++out.on_cells;
        look_at(cell.z);
      },
      [&](Point, double z) {
        ++out.others;
        look_at(z);
      });
  if (!finished) return std::nullopt;
  return out;
}

/// Such that whole heights have about 24 bits.
int fine_shift(double largest) {
  constexpr int kBits = 24, kMostShift = 12;
  return std::clamp(kBits - 1 - std::ilogb(std::max(largest, 1.0)), 0, kMostShift);
}

/// A raster that few samples are left of is not worth scanning cell by cell.
bool is_worth_scanning(const SourceGrid& grid, const Survey& found) {
  const double cells = static_cast<double>(grid.width) * grid.height;
  return found.on_cells > found.others && cells <= 16.0 * static_cast<double>(found.on_cells) &&
         cells + static_cast<double>(found.others) < 0x1p+32 && std::max(grid.width, grid.height) < kMostCells;
}

std::vector<Facet::Corner> points_of(const Input& input, bool with_cells, std::size_t count,
                                     const base::Progress* progress) {
  std::vector<Facet::Corner> out;
  out.reserve(count);
  input.visit(
      progress,
      [&](const CellSample& cell) {
        if (with_cells) out.push_back({input.grid()->centre(cell.column, cell.row), cell.z});
      },
      [&](Point p, double z) {
        out.push_back({p, z});
      });
  return out;
}

template <class Grid>
std::unique_ptr<Samples> filled(std::unique_ptr<Grid> grid, const Input& input, const GridKeeping& keeping) {
  if (is_cancelled(keeping.progress))
    return nullptr;  // while it was made; what comes after that asks no more of it
  const base::Pace pace(keeping.memory);
  std::int32_t row = -1;
  const auto put = [&](const CellSample& cell) {
    if (cell.row != row) pace.touched(1, static_cast<std::size_t>(input.grid()->width) * sizeof(double));
    row = cell.row;
    grid->put(cell);
  };
  const bool finished = input.visit(keeping.progress, put, [](Point, double) {});
  return finished ? std::move(grid) : nullptr;
}

}  // namespace

void Samples::sites(SampleIndex begin, SampleIndex end, std::vector<Site>& out) const {
  for (SampleIndex sample = begin; sample < end; ++sample) {
    if (exists(sample)) out.push_back(site(sample));
  }
}

std::vector<SampleIndex> hull_corners(const Samples& samples, const terrain::Box& box) {
  std::vector<SampleIndex> found;
  samples.outermost(box, found);
  std::vector<std::pair<Point, SampleIndex>> points;
  for (const SampleIndex sample : found) points.emplace_back(samples.position(sample), sample);
  std::sort(points.begin(), points.end());
  // Andrew's monotone chain: below from left to right, then above from right to left.
  std::vector<std::pair<Point, SampleIndex>> chain;
  std::size_t kept = 0;  // that the present half may not take back
  const auto add = [&](const std::pair<Point, SampleIndex>& next) {
    while (chain.size() >= kept + 2 &&
           exact::orientation(chain[chain.size() - 2].first, chain.back().first, next.first) <= 0) {
      chain.pop_back();
    }
    chain.push_back(next);
  };
  for (const auto& point : points) add(point);
  kept = chain.empty() ? 0 : chain.size() - 1;
  for (auto point = points.rbegin(); point != points.rend(); ++point) {
    if (point != points.rbegin()) add(*point);
  }
  if (chain.size() > 1) chain.pop_back();  // the first one again
  std::vector<SampleIndex> out;
  for (const auto& [at, sample] : chain) out.push_back(sample);
  return out;
}

namespace {

bool take(const Demands& demands, std::size_t bytes) {
  return demands.footprint == nullptr || demands.footprint->take(bytes);
}

std::unique_ptr<Samples> plain_samples(const Terrain* terrain, const SourceSamples* source, std::span<const Placement> own,
                                       const Demands& demands, base::Progress* progress) {
  const Input input(terrain, source, own);
  const auto found = survey(input, progress);
  if (!found) return nullptr;
  const SourceGrid* const grid = input.grid();
  if (!take(demands, found->others * PointSamples::kBytesPerSample)) return nullptr;
  if (grid != nullptr && is_worth_scanning(*grid, *found)) {
    auto others =
        found->others == 0 ? std::vector<Facet::Corner>() : points_of(input, false, found->others, progress);
    const GridKeeping keeping{demands.memory, progress, demands.footprint};
    const int shift = demands.any_height ? std::max(found->shift, fine_shift(found->largest)) : found->shift;
    const double largest = demands.any_height ? 2 * found->largest : found->largest;
    if (WholeGridSamples::can_hold(*grid, shift, largest)) {
      return filled(std::make_unique<WholeGridSamples>(*grid, shift, largest, demands.any_height,
                                                       std::move(others), keeping),
                    input, keeping);
    }
    if (RealGridSamples::can_hold(found->largest)) {
      return filled(std::make_unique<RealGridSamples>(*grid, std::move(others), keeping), input, keeping);
    }
  }
  if (!take(demands, found->on_cells * PointSamples::kBytesPerSample)) return nullptr;
  auto points = std::make_unique<PointSamples>(
      points_of(input, true, found->on_cells + found->others, progress), 0, progress, demands.footprint);
  if (is_cancelled(progress)) return nullptr;
  return points;
}

std::unique_ptr<Samples> demanding_samples(std::unique_ptr<Samples> samples, const Demands& demands,
                                           base::Progress* progress) {
  if (hull_corners(*samples, samples->extent().box).size() < 3) return samples;  // all in a line: all of them stay
  std::shared_ptr<const SourceMesh> mesh;
  if (demands.surface || !samples->has_neighbours()) {
    if (!take(demands, samples->extent().samples * SourceMesh::kBytesPerSample)) return nullptr;
    mesh = SourceMesh::of(*samples, demands.threads, progress);
  }
  if (is_cancelled(progress)) return nullptr;
  if (demands.keep_flat > 0) samples = with_plateaus(std::move(samples), mesh.get(), demands.keep_flat, progress);
  if (demands.surface) samples = with_surface(std::move(samples), mesh);
  return samples;
}

}  // namespace

std::unique_ptr<Samples> make_samples(const Terrain* terrain, const SourceSamples* source,
                                      std::span<const Placement> own, const Demands& demands,
                                      base::Progress* progress) {
  auto samples = plain_samples(terrain, source, own, demands, progress);
  if (samples != nullptr && (demands.keep_flat > 0 || demands.surface))
    samples = demanding_samples(std::move(samples), demands, progress);
  const bool is_over = demands.footprint != nullptr && demands.footprint->is_over();
  return is_cancelled(progress) || is_over ? nullptr : std::move(samples);
}

}  // namespace tin::simplify
