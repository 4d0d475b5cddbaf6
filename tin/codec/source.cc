#include "tin/codec/source.h"

#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "tin/base/check.h"
#include "tin/codec/bytes_internal.h"

namespace tin::codec {
namespace {

using exact::Point;
using terrain::SourceGrid;
using terrain::SourceSamples;
using Heights = SourceSamples::Heights;

constexpr std::string_view kMagic = "TNSS";
constexpr std::uint16_t kVersion = 1;
constexpr std::uint8_t kRaster = 1, kPoints = 2;
constexpr std::uint8_t kForms = 4;  // of heights: the alternatives of Heights::stored, in order
constexpr std::uint64_t kMostShift = 63;
constexpr std::size_t kSmallestPoint = 2;  // two differences; heights come after all positions

/// Heights as whole numbers of which neighbours differ little: integers as they are, floats by their rank.
template <class T>
std::int64_t rank_of(T value) {
  if constexpr (std::is_integral_v<T>) {
    return value;
  } else {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return std::int64_t{(bits >> 31) != 0 ? ~bits : bits | 0x80000000U};
  }
}

/// Nothing when no value has the rank.
template <class T>
std::optional<T> of_rank(std::int64_t rank) {
  if constexpr (std::is_integral_v<T>) {
    if (!std::in_range<T>(rank)) return std::nullopt;
    return static_cast<T>(rank);
  } else {
    if (!std::in_range<std::uint32_t>(rank)) return std::nullopt;
    const auto ordered = static_cast<std::uint32_t>(rank);
    const T value = std::bit_cast<T>((ordered >> 31) != 0 ? ordered & 0x7fffffffU : ~ordered);
    return std::isfinite(value) ? std::optional(value) : std::nullopt;
  }
}

/// Foretells each height from those before it: along the plane through the pixels to the west, north and
/// north-west where these are samples, else from one of them, else from the one before.
template <class T>
class Forecast {
 public:
  Forecast(const base::Array<T>& values, const SourceGrid* grid) : values_(values), grid_(grid) {}

  std::int64_t operator()(std::size_t i) const {
    if (grid_ == nullptr) return i == 0 ? 0 : rank_of(values_[i - 1]);
    const auto width = static_cast<std::size_t>(grid_->width);
    const bool has_west = i % width != 0 && valid(i - 1), has_north = i >= width && valid(i - width);
    if (has_west && has_north && valid(i - width - 1))
      return rank_of(values_[i - 1]) + rank_of(values_[i - width]) - rank_of(values_[i - width - 1]);
    if (has_west) return rank_of(values_[i - 1]);
    if (has_north) return rank_of(values_[i - width]);
    return last_;
  }
  void note(std::int64_t rank) { last_ = rank; }

 private:
  bool valid(std::size_t i) const {
    return grid_->valid.empty() || ((grid_->valid[i / 64] >> (i % 64)) & 1U) != 0;
  }

  const base::Array<T>& values_;
  const SourceGrid* grid_;
  std::int64_t last_ = 0;
};

bool is_sample(const SourceGrid* grid, std::size_t i) {
  return grid == nullptr || grid->valid.empty() || ((grid->valid[i / 64] >> (i % 64)) & 1U) != 0;
}

constexpr std::size_t kAtOnce = std::size_t{1}
                                << 16;  // heights or positions between two looks at how many bytes there are

template <class T>
base::Result<void> write_heights(Writer& out, const base::Array<T>& values, const SourceGrid* grid,
                                 const Sink& sink) {
  const base::Pace pace(values.get_allocator().memory());
  Forecast forecast(values, grid);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i % kAtOnce == 0) {
      pace.touched(1, kAtOnce * sizeof(T));
      if (auto flushed = out.flush(sink); !flushed) return flushed;
    }
    if (!is_sample(grid, i)) continue;
    if constexpr (std::is_same_v<T, double>) {
      out.f64(values[i]);
    } else {
      const std::int64_t rank = rank_of(values[i]);
      out.zigzag(rank - forecast(i));
      forecast.note(rank);
    }
  }
  return {};
}

template <class T>
base::Array<T> read_heights(Reader& in, std::size_t count, const SourceGrid* grid,
                            std::pmr::memory_resource* memory) {
  const base::Pace pace(memory);
  base::Array<T> values = base::filled(count, T{}, memory);
  Forecast forecast(values, grid);
  for (std::size_t i = 0; i < count && in.ok(); ++i) {
    if (i % kAtOnce == 0) pace.touched(2, kAtOnce * sizeof(double));  // the bytes and the heights
    if (!is_sample(grid, i)) continue;
    if constexpr (std::is_same_v<T, double>) {
      values[i] = in.f64();
      in.require(std::isfinite(values[i]), "a height is not finite");
    } else {
      // Forecasts of 32-bit ranks stay far below the bound; no sum overflows.
      const std::int64_t difference = in.zigzag();
      in.require(difference > -(std::int64_t{1} << 40) && difference < std::int64_t{1} << 40,
                 "a height is too large");
      if (!in.ok()) break;
      const auto value = of_rank<T>(forecast(i) + difference);
      in.require(value.has_value(), "a height is too large");
      values[i] = value.value_or(T{});
      forecast.note(rank_of(values[i]));
    }
  }
  return values;
}

base::Result<void> write_positions(Writer& out, std::span<const Point> points, const Sink& sink) {
  out.varint(points.size());
  Point previous{-exact::kLatticeHalf, 0};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point p = points[i];
    out.varint(static_cast<std::uint64_t>(std::int64_t{p.x} - previous.x));
    out.zigzag(std::int64_t{p.y} - previous.y);
    previous = p;
    if (i % kAtOnce != 0) continue;
    if (auto flushed = out.flush(sink); !flushed) return flushed;
  }
  return {};
}

std::vector<Point> read_positions(Reader& in) {
  const std::size_t count = in.count(kSmallestPoint);
  std::vector<Point> points;
  points.reserve(count);
  Point previous{-exact::kLatticeHalf, 0};
  constexpr std::int64_t kMost = 2 * std::int64_t{exact::kLatticeHalf};
  for (std::size_t i = 0; i < count && in.ok(); ++i) {
    const std::uint64_t dx = in.varint();
    const std::int64_t dy = in.zigzag();
    in.require(dx < static_cast<std::uint64_t>(kMost) && dy > -kMost && dy < kMost,
               "a position is outside the lattice");
    if (!in.ok()) break;
    const std::int64_t x = previous.x + static_cast<std::int64_t>(dx), y = previous.y + dy;
    in.require(exact::in_lattice(x, y), "a position is outside the lattice");
    in.require(i == 0 || dx > 0 || dy > 0, "positions do not ascend");
    if (!in.ok()) break;
    previous = {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
    points.push_back(previous);
  }
  return points;
}

Heights read_form(Reader& in, std::size_t count, const SourceGrid* grid, std::pmr::memory_resource* memory) {
  const std::uint8_t form = in.u8();
  const std::uint64_t shift = in.varint();
  in.require(form < kForms, "an unknown form of heights");
  in.require(shift <= kMostShift && (form < 2 || shift == 0), "a shift of heights makes no sense");
  if (!in.ok()) return {};
  const auto with = [&](auto values) { return Heights{std::move(values), static_cast<int>(shift)}; };
  switch (form) {
    case 0:
      return with(read_heights<std::int16_t>(in, count, grid, memory));
    case 1:
      return with(read_heights<std::int32_t>(in, count, grid, memory));
    case 2:
      return with(read_heights<float>(in, count, grid, memory));
    default:
      return with(read_heights<double>(in, count, grid, memory));
  }
}

SourceSamples read_raster(Reader& in, std::shared_ptr<const SourceGrid> grid,
                          std::pmr::memory_resource* memory) {
  const std::uint64_t width = in.varint(), height = in.varint();
  in.require(std::cmp_equal(width, grid->width) && std::cmp_equal(height, grid->height),
             "the raster is not of the grid's size");
  if (!in.ok()) return SourceSamples::points({});
  Heights heights = read_form(in, static_cast<std::size_t>(width * height), grid.get(), memory);
  if (!in.ok()) return SourceSamples::points({});
  std::vector<std::uint64_t> valid = grid->valid;
  return SourceSamples::restored_raster(std::move(grid), std::move(heights), std::move(valid));
}

SourceSamples read_points(Reader& in, std::pmr::memory_resource* memory) {
  std::vector<Point> positions = read_positions(in);
  Heights heights = read_form(in, positions.size(), nullptr, memory);
  if (!in.ok()) return SourceSamples::points({});
  return SourceSamples::restored_points(std::move(positions), std::move(heights));
}

}  // namespace

base::Result<void> encode_source(const SourceSamples& source, const Sink& sink) {
  Writer out(kMagic, kVersion);
  const SourceGrid* const grid = source.grid().get();
  out.u8(source.is_raster() ? kRaster : kPoints);
  if (grid != nullptr) {
    out.varint(static_cast<std::uint64_t>(grid->width));
    out.varint(static_cast<std::uint64_t>(grid->height));
  } else if (auto written = write_positions(out, source.positions(), sink); !written) {
    return written;
  }
  out.u8(static_cast<std::uint8_t>(source.heights().stored.index()));
  out.varint(static_cast<std::uint64_t>(source.heights().shift));
  auto written = std::visit([&](const auto& values) { return write_heights(out, values, grid, sink); },
                            source.heights().stored);
  if (!written) return written;
  return sink(out.finish());
}

std::string encode_source(const SourceSamples& source) {
  std::string bytes;
  const auto done = encode_source(source, [&bytes](std::string_view piece) -> base::Result<void> {
    bytes += piece;
    return {};
  });
  TIN_CHECK(done.ok());
  return bytes;
}

base::Result<SourceSamples> decode_source(std::string_view bytes, std::shared_ptr<const SourceGrid> grid,
                                          std::pmr::memory_resource* memory) {
  Reader in(bytes, kMagic, kVersion, "source", base::Pace(memory));
  const std::uint8_t kind = in.u8();
  in.require(kind == kRaster || kind == kPoints, "an unknown kind of source");
  in.require((kind == kRaster) == (grid != nullptr), "a raster without its grid, or points with one");
  if (!in.ok()) return in.error();
  SourceSamples source = kind == kRaster ? read_raster(in, std::move(grid), memory) : read_points(in, memory);
  in.finish();
  if (!in.ok()) return in.error();
  return source;
}

}  // namespace tin::codec
