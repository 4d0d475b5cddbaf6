#include "tin/simplify/whole_scan.h"

#include <algorithm>
#include <array>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace tin::simplify {

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

/// All numbers are whole and below 2^53, so nothing is rounded, whatever the order.
__attribute__((target("avx2,fma"))) WorstCell scan_four_at_a_time(const WholeHeights& heights, const WholePlane& plane,
                                                                  double stop) {
  GridPoint a = plane.a, b = plane.b, c = plane.c;
  const bool bend_is_right = sort_by_row(a, b, c);
  const Side through(a, c);
  const auto slope_x = static_cast<double>(plane.slope_x), slope_y = static_cast<double>(plane.slope_y);
  const __m256d ramp = _mm256_mul_pd(_mm256_set1_pd(slope_x), _mm256_set_pd(3, 2, 1, 0));
  const __m256d area = _mm256_set1_pd(static_cast<double>(plane.area)), sign = _mm256_set1_pd(-0.0);
  const __m128i lanes = _mm_set_epi32(3, 2, 1, 0), nothing = _mm_set1_epi32(WholeHeights::kVoid);
  __m256d worst = _mm256_setzero_pd(), at = _mm256_setzero_pd();
  bool go_on = true;
  for (int half = 0; half < 2 && go_on; ++half) {
    const Side side = half == 0 ? Side(a, b) : Side(b, c);
    const Side &left = bend_is_right ? through : side, &right = bend_is_right ? side : through;
    const std::int32_t end = half == 0 ? b.y : c.y + 1;
    for (std::int32_t row = half == 0 ? a.y : b.y; row < end && go_on; ++row) {
      const std::int32_t last = right.floor(row), start = row * heights.width;
      const double along = static_cast<double>(plane.base) + (row - plane.a.y) * slope_y;
      for (std::int32_t column = left.ceil(row); column <= last; column += 4) {
        const __m128i z = _mm_loadu_si128(reinterpret_cast<const __m128i*>(heights.z + start + column));
        const __m128i counts =
            _mm_and_si128(_mm_cmpgt_epi32(_mm_set1_epi32(last - column + 1), lanes), _mm_cmpgt_epi32(z, nothing));
        const __m256d over = _mm256_add_pd(_mm256_set1_pd(along + (column - plane.a.x) * slope_x), ramp);
        const __m256d distance = _mm256_and_pd(
            _mm256_andnot_pd(sign, _mm256_fnmadd_pd(area, _mm256_cvtepi32_pd(z), over)),
            _mm256_castsi256_pd(_mm256_cvtepi32_epi64(counts)));
        const __m256d here = _mm256_cvtepi32_pd(_mm_add_epi32(_mm_set1_epi32(start + column), lanes));
        at = _mm256_blendv_pd(at, here, _mm256_cmp_pd(distance, worst, _CMP_GT_OQ));
        worst = _mm256_max_pd(distance, worst);
      }
      go_on = _mm256_movemask_pd(_mm256_cmp_pd(worst, _mm256_set1_pd(stop), _CMP_GT_OQ)) == 0;
    }
  }
  std::array<double, 4> distances{};
  std::array<std::int32_t, 4> cells{};
  _mm256_storeu_pd(distances.data(), worst);
  _mm_storeu_si128(reinterpret_cast<__m128i*>(cells.data()), _mm256_cvtpd_epi32(at));
  return best_of(distances, cells);
}

}  // namespace

WorstCell scan_by_doubles(const WholeHeights& heights, const WholePlane& plane, std::int64_t stop) {
  if (kHasAvx2) return scan_four_at_a_time(heights, plane, static_cast<double>(stop));
  return scan_by_integers(heights, plane, stop);
}

#else

WorstCell scan_by_doubles(const WholeHeights& heights, const WholePlane& plane, std::int64_t stop) {
  return scan_by_integers(heights, plane, stop);
}

#endif

}  // namespace tin::simplify
