#include "tin/simplify/whole_scan.h"

#include <algorithm>
#include <array>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace tin::simplify {

namespace {

/// Looks at one more cell.
void look_at(GridPoint cell, const WholeHeights& heights, const WholePlane& plane, WorstCell& worst) {
  const std::uint32_t at = static_cast<std::uint32_t>(cell.y) * static_cast<std::uint32_t>(heights.width) +
                           static_cast<std::uint32_t>(cell.x);
  const std::int32_t z = heights.z[at];
  const std::int64_t difference =
      plane.base + (cell.x - plane.a.x) * plane.slope_x + (cell.y - plane.a.y) * plane.slope_y - plane.area * z;
  const std::int64_t distance = difference < 0 ? -difference : difference;
  if (z == WholeHeights::kVoid || distance < worst.distance || (distance == worst.distance && at > worst.at)) return;
  worst = {distance, at};
}

bool is_multiple(GridPoint from, GridPoint to, std::int32_t parts) {
  return (to.x - from.x) % parts == 0 && (to.y - from.y) % parts == 0;
}

}  // namespace

WorstCell scan_beside_corners(const WholeHeights& heights, const WholePlane& plane) {
  WorstCell worst{0, UINT32_MAX};
  const GridPoint a = plane.a, b = plane.b, c = plane.c;
  if (plane.area == 2) {  // the middle of one side
    const bool of_ab = is_multiple(a, b, 2), of_bc = !of_ab && is_multiple(b, c, 2);
    const GridPoint from = of_bc ? c : a, to = of_ab || of_bc ? b : c;
    look_at({(from.x + to.x) / 2, (from.y + to.y) / 2}, heights, plane, worst);
  } else if (plane.area == 3) {  // the centre, or both thirds of one side
    const GridPoint sum{a.x + b.x + c.x, a.y + b.y + c.y};
    if (sum.x % 3 == 0 && sum.y % 3 == 0) {
      look_at({sum.x / 3, sum.y / 3}, heights, plane, worst);
    } else {
      const bool of_ab = is_multiple(a, b, 3), of_bc = !of_ab && is_multiple(b, c, 3);
      const GridPoint from = of_bc ? c : a, to = of_ab || of_bc ? b : c;
      look_at({(2 * from.x + to.x) / 3, (2 * from.y + to.y) / 3}, heights, plane, worst);
      look_at({(from.x + 2 * to.x) / 3, (from.y + 2 * to.y) / 3}, heights, plane, worst);
    }
  }
  return worst.distance == 0 ? WorstCell{} : worst;
}

WorstCell scan_by_integers(const WholeHeights& heights, const WholePlane& plane, std::int64_t stop) {
  WorstCell worst;
  visit_spans(plane.a, plane.b, plane.c, [&](std::int32_t row, std::int32_t first, std::int32_t last) {
    const std::uint32_t start = static_cast<std::uint32_t>(row) * static_cast<std::uint32_t>(heights.width) +
                                static_cast<std::uint32_t>(first);
    const std::int32_t* const z = heights.z + start;
    std::int64_t over = plane.base + (first - plane.a.x) * plane.slope_x + (row - plane.a.y) * plane.slope_y;
    const std::int32_t count = last - first + 1;
    for (std::int32_t i = 0; i < count; ++i, over += plane.slope_x) {
      const std::int64_t difference = over - plane.area * z[i];
      const std::int64_t distance = difference < 0 ? -difference : difference;
      if (distance <= worst.distance || z[i] == WholeHeights::kVoid) continue;
      worst = {distance, start + static_cast<std::uint32_t>(i)};
    }
    return worst.distance <= stop;
  });
  return worst;
}

bool doubles_suffice(const WholePlane& plane, double largest) {
  const auto [low_x, high_x] = std::minmax({plane.a.x, plane.b.x, plane.c.x});
  const auto [low_y, high_y] = std::minmax({plane.a.y, plane.b.y, plane.c.y});
  // Slopes are at most 4 * largest times a side of the box; two of them and `base` are added.
  return 16 * largest * (1.0 + high_x - low_x) * (1.0 + high_y - low_y) < 0x1p+53;
}

#if defined(__x86_64__)

namespace {

const bool kHasAvx2 = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;

/// The four lanes' findings as one.
WorstCell best_of(const std::array<double, 4>& distances, const std::array<std::int32_t, 4>& cells) {
  WorstCell out;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto distance = static_cast<std::int64_t>(distances[i]);
    const auto cell = static_cast<std::uint32_t>(cells[i]);
    if (distance > out.distance || (distance == out.distance && distance > 0 && cell < out.at)) out = {distance, cell};
  }
  return out;
}

/// Where each row of a triangle begins and ends; for triangles of up to kMost rows.
struct Rows {
  static constexpr std::int32_t kMost = 64;
  alignas(16) std::array<std::int32_t, kMost> first, last;
};

/// The same rounding as Side's, four rows at a time: one loop instead of one for each half, whose ends a processor guesses wrong.
__attribute__((target("avx2,fma"))) void find_rows(GridPoint a, GridPoint b, GridPoint c, bool bend_is_right, Rows& rows) {
  const auto slope = [](GridPoint top, GridPoint bottom) {
    return top.y == bottom.y ? 0 : static_cast<double>(bottom.x - top.x) / (bottom.y - top.y);
  };
  const __m256d long_slope = _mm256_set1_pd(slope(a, c)), upper = _mm256_set1_pd(slope(a, b)), lower = _mm256_set1_pd(slope(b, c));
  const __m256d ax = _mm256_set1_pd(a.x), bx = _mm256_set1_pd(b.x), bend = _mm256_set1_pd(b.y - a.y);
  const __m256d to_left = _mm256_set1_pd(Side::kToCeil), to_right = _mm256_set1_pd(Side::kToFloor);
  const __m128i bias = _mm_set1_epi32(Side::kBias);
  __m256d row = _mm256_set_pd(3, 2, 1, 0);
  const std::int32_t count = c.y - a.y + 1;
  for (std::int32_t i = 0; i < count; i += 4, row = _mm256_add_pd(row, _mm256_set1_pd(4))) {
    const __m256d through = _mm256_fmadd_pd(row, long_slope, ax);
    const __m256d over = _mm256_fmadd_pd(row, upper, ax), under = _mm256_fmadd_pd(_mm256_sub_pd(row, bend), lower, bx);
    const __m256d side = _mm256_blendv_pd(under, over, _mm256_cmp_pd(row, bend, _CMP_LT_OQ));
    const __m256d left = bend_is_right ? through : side, right = bend_is_right ? side : through;
    const auto store = [i](std::array<std::int32_t, Rows::kMost>& to) { return reinterpret_cast<__m128i*>(to.data() + i); };
    _mm_store_si128(store(rows.first), _mm_sub_epi32(_mm256_cvttpd_epi32(_mm256_add_pd(left, to_left)), bias));
    _mm_store_si128(store(rows.last), _mm_sub_epi32(_mm256_cvttpd_epi32(_mm256_add_pd(right, to_right)), bias));
  }
}

/// All numbers are whole and below 2^53, so nothing is rounded, whatever the order.
__attribute__((target("avx2,fma"))) WorstCell scan_four_at_a_time(const WholeHeights& heights, const WholePlane& plane,
                                                                  double stop) {
  GridPoint a = plane.a, b = plane.b, c = plane.c;
  const bool bend_is_right = sort_by_row(a, b, c);
  Rows rows;
  find_rows(a, b, c, bend_is_right, rows);
  const auto slope_x = static_cast<double>(plane.slope_x), slope_y = static_cast<double>(plane.slope_y);
  const __m256d ramp = _mm256_mul_pd(_mm256_set1_pd(slope_x), _mm256_set_pd(3, 2, 1, 0));
  const __m256d area = _mm256_set1_pd(static_cast<double>(plane.area)), sign = _mm256_set1_pd(-0.0);
  const __m256d limit = _mm256_set1_pd(stop);
  const __m128i lanes = _mm_set_epi32(3, 2, 1, 0), nothing = _mm_set1_epi32(WholeHeights::kVoid);
  __m256d worst = _mm256_setzero_pd();
  __m128i at = _mm_setzero_si128();
  double along = static_cast<double>(plane.base) + (a.y - plane.a.y) * slope_y;
  std::int32_t start = a.y * heights.width;
  const std::int32_t count = c.y - a.y + 1;
  for (std::int32_t i = 0; i < count; ++i, start += heights.width, along += slope_y) {
    const std::int32_t last = rows.last[static_cast<std::size_t>(i)];
    for (std::int32_t column = rows.first[static_cast<std::size_t>(i)]; column <= last; column += 4) {
      const __m128i z = _mm_loadu_si128(reinterpret_cast<const __m128i*>(heights.z + start + column));
      const __m128i counts =
          _mm_and_si128(_mm_cmpgt_epi32(_mm_set1_epi32(last - column + 1), lanes), _mm_cmpgt_epi32(z, nothing));
      const __m256d over = _mm256_add_pd(_mm256_set1_pd(along + (column - plane.a.x) * slope_x), ramp);
      const __m256d distance =
          _mm256_and_pd(_mm256_andnot_pd(sign, _mm256_fnmadd_pd(area, _mm256_cvtepi32_pd(z), over)),
                        _mm256_castsi256_pd(_mm256_cvtepi32_epi64(counts)));
      const __m256i better = _mm256_castpd_si256(_mm256_cmp_pd(distance, worst, _CMP_GT_OQ));
      const __m128i narrow = _mm256_castsi256_si128(_mm256_permutevar8x32_epi32(better, _mm256_set_epi32(6, 4, 2, 0, 6, 4, 2, 0)));
      at = _mm_blendv_epi8(at, _mm_add_epi32(_mm_set1_epi32(start + column), lanes), narrow);
      worst = _mm256_max_pd(distance, worst);
    }
    if (_mm256_movemask_pd(_mm256_cmp_pd(worst, limit, _CMP_GT_OQ)) != 0) break;
  }
  std::array<double, 4> distances{};
  std::array<std::int32_t, 4> cells{};
  _mm256_storeu_pd(distances.data(), worst);
  _mm_storeu_si128(reinterpret_cast<__m128i*>(cells.data()), at);
  return best_of(distances, cells);
}

}  // namespace

WorstCell scan_by_doubles(const WholeHeights& heights, const WholePlane& plane, std::int64_t stop) {
  const auto [low, high] = std::minmax({plane.a.y, plane.b.y, plane.c.y});
  if (kHasAvx2 && high - low < Rows::kMost) return scan_four_at_a_time(heights, plane, static_cast<double>(stop));
  return scan_by_integers(heights, plane, stop);
}

#else

WorstCell scan_by_doubles(const WholeHeights& heights, const WholePlane& plane, std::int64_t stop) {
  return scan_by_integers(heights, plane, stop);
}

#endif

}  // namespace tin::simplify
