#include "tin/terrain/source_samples.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "tin/base/check.h"

namespace tin::terrain {

using exact::Point;

namespace {

constexpr int kMostShift = 16;

/// Whether all heights are whole multiples of 2^-shift and fit T then.
template <class T>
bool fit(std::span<const double> heights, int shift) {
  return std::all_of(heights.begin(), heights.end(), [shift](double z) {
    if (std::isnan(z)) return true;
    const double scaled = std::ldexp(z, shift);
    return scaled == std::trunc(scaled) && scaled >= std::numeric_limits<T>::min() &&
           scaled <= std::numeric_limits<T>::max() && !(z == 0 && std::signbit(z));
  });
}

template <class T>
base::Array<T> stored(std::span<const double> heights, int shift) {
  base::Array<T> out;
  out.reserve(heights.size());
  for (const double z : heights) out.push_back(std::isnan(z) ? T{} : static_cast<T>(std::ldexp(z, shift)));
  return out;
}

SourceSamples::Heights narrowest(std::span<const double> heights) {
  if (fit<std::int16_t>(heights, 0)) return {stored<std::int16_t>(heights, 0), 0};
  for (int shift = 0; shift <= kMostShift; shift += 4) {
    if (fit<std::int16_t>(heights, shift)) return {stored<std::int16_t>(heights, shift), shift};
    if (fit<std::int32_t>(heights, shift)) return {stored<std::int32_t>(heights, shift), shift};
  }
  const bool single = std::all_of(heights.begin(), heights.end(), [](double z) {
    return std::isnan(z) || (std::abs(z) < 1e38 && static_cast<double>(static_cast<float>(z)) == z);
  });
  if (single) return {stored<float>(heights, 0), 0};
  return {stored<double>(heights, 0), 0};
}

}  // namespace

double SourceSamples::Heights::at(std::size_t i) const {
  return std::visit(
      [&](const auto& values) {
        const auto value = static_cast<double>(values[i]);
        return shift == 0 ? value : std::ldexp(value, -shift);
      },
      stored);
}

std::size_t SourceSamples::Heights::size() const {
  return std::visit([](const auto& values) { return values.size(); }, stored);
}

std::pmr::memory_resource* SourceSamples::Heights::memory() const {
  return std::visit([](const auto& values) { return values.get_allocator().memory(); }, stored);
}

std::size_t SourceSamples::Heights::bytes_each() const {
  return std::visit([](const auto& values) { return sizeof(values[0]); }, stored);
}

SourceSamples SourceSamples::raster(std::shared_ptr<const SourceGrid> grid, std::span<const double> heights) {
  std::vector<std::uint64_t> valid((heights.size() + 63) / 64, 0);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const bool in_grid = grid->valid.empty() || ((grid->valid[i / 64] >> (i % 64)) & 1U) != 0;
    if (in_grid && !std::isnan(heights[i])) valid[i / 64] |= std::uint64_t{1} << (i % 64);
  }
  return restored_raster(std::move(grid), narrowest(heights), std::move(valid));
}

SourceSamples SourceSamples::restored_raster(std::shared_ptr<const SourceGrid> grid, Heights heights,
                                             std::vector<std::uint64_t> valid) {
  TIN_CHECK(heights.size() == static_cast<std::size_t>(grid->width) * static_cast<std::size_t>(grid->height));
  TIN_CHECK(valid.empty() || valid.size() == (heights.size() + 63) / 64);
  SourceSamples out;
  out.grid_ = std::move(grid);
  out.heights_ = std::make_shared<const Heights>(std::move(heights));
  out.valid_ = std::move(valid);
  out.count();
  return out;
}

SourceSamples SourceSamples::points(std::vector<Placement> points) {
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.at < b.at; });
  std::vector<Point> at;
  std::vector<double> heights;
  for (const Placement& point : points) {
    at.push_back(point.at);
    heights.push_back(point.z);
  }
  SourceSamples out;
  out.points_ = std::make_shared<const std::vector<Point>>(std::move(at));
  out.heights_ = std::make_shared<const Heights>(narrowest(heights));
  out.count();
  return out;
}

SourceSamples SourceSamples::restored_points(std::vector<Point> positions, Heights heights) {
  TIN_CHECK(positions.size() == heights.size());
  SourceSamples out;
  out.points_ = std::make_shared<const std::vector<Point>>(std::move(positions));
  out.heights_ = std::make_shared<const Heights>(std::move(heights));
  out.count();
  return out;
}

/// Counts the samples; where all are valid, no bits are kept.
void SourceSamples::count() {
  count_ = size();
  if (valid_.empty()) return;
  count_ = 0;
  for (const std::uint64_t word : valid_) count_ += static_cast<std::size_t>(std::popcount(word));
  if (count_ == size()) valid_.clear();
}

Point SourceSamples::at(std::size_t i) const {
  if (!is_raster()) return (*points_)[i];
  const auto width = static_cast<std::size_t>(grid_->width);
  return grid_->centre(static_cast<std::int32_t>(i % width), static_cast<std::int32_t>(i / width));
}

std::optional<std::size_t> SourceSamples::find(Point p) const {
  std::size_t i = 0;
  if (is_raster()) {
    const auto cell = grid_->cell_centred_at(p);
    if (!cell) return std::nullopt;
    i = static_cast<std::size_t>(cell->row) * static_cast<std::size_t>(grid_->width) +
        static_cast<std::size_t>(cell->column);
  } else {
    const auto found = std::lower_bound(points_->begin(), points_->end(), p);
    if (found == points_->end() || *found != p) return std::nullopt;
    i = static_cast<std::size_t>(found - points_->begin());
  }
  return is_sample(i) ? std::optional(i) : std::nullopt;
}

SourceSamples SourceSamples::without(std::span<const std::size_t> samples) const {
  SourceSamples out = *this;
  if (out.valid_.empty() && !samples.empty()) {
    out.valid_.assign((size() + 63) / 64, ~std::uint64_t{0});
    if (size() % 64 != 0) out.valid_.back() = (std::uint64_t{1} << (size() % 64)) - 1;
  }
  for (const std::size_t i : samples) out.valid_[i / 64] &= ~(std::uint64_t{1} << (i % 64));
  out.count();
  return out;
}

}  // namespace tin::terrain
