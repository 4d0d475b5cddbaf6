#include "tin/delaunay/hilbert_sort.h"

#include <algorithm>
#include <array>
#include <bit>

#include "tin/delaunay/hilbert.h"
#include "tin/delaunay/threads.h"

namespace tin::delaunay {

using exact::Point;

namespace {

constexpr int kKeyBits = 32;
constexpr std::size_t kSmall = 24;     // sorted by insertion
constexpr int kMaxDigit = 11;          // bits: as many buckets as the caches and the TLB bear
constexpr std::size_t kMaxBuckets = std::size_t{1} << kMaxDigit;

bool before(const OnCurve& a, const OnCurve& b) {
  return a.key != b.key ? a.key < b.key : a.index < b.index;
}

void insertion_sort(OnCurve* a, std::size_t n) {
  for (std::size_t i = 1; i < n; ++i) {
    const OnCurve moving = a[i];
    std::size_t j = i;
    for (; j > 0 && before(moving, a[j - 1]); --j) a[j] = a[j - 1];
    a[j] = moving;
  }
}

/// The topmost digit in which keys differ.
struct Digit {
  int shift;
  int bits;
  std::size_t of(const OnCurve& item) const {
    return static_cast<std::size_t>(item.key >> shift) & ((std::size_t{1} << bits) - 1);
  }
};

/// About four items to a bucket, so that the next round ends. `differ` has a bit where two keys differ, and
/// is not 0.
Digit choose_digit(std::uint32_t differ, std::size_t n) {
  const int top = 32 - std::countl_zero(differ);
  const int wanted = std::clamp(static_cast<int>(std::bit_width(n)) - 3, 3, kMaxDigit);
  const int bits = std::min(wanted, top);
  return {top - bits, bits};
}

std::uint32_t differing_bits(const OnCurve* a, std::size_t n) {
  std::uint32_t differ = 0;
  for (std::size_t i = 1; i < n; ++i) differ |= a[i].key ^ a[0].key;
  return differ;
}

/// Sorts a[0..n), using scratch[0..n). Equal keys stay in ascending order of their index.
void sort_range(OnCurve* a, OnCurve* scratch, std::size_t n) {
  if (n <= kSmall) return insertion_sort(a, n);
  const std::uint32_t differ = differing_bits(a, n);
  if (differ == 0) return;
  const Digit digit = choose_digit(differ, n);
  std::array<std::uint32_t, kMaxBuckets + 1> ends;
  const std::size_t buckets = std::size_t{1} << digit.bits;
  std::fill_n(ends.begin(), buckets + 1, 0);
  for (std::size_t i = 0; i < n; ++i) ++ends[digit.of(a[i]) + 1];
  for (std::size_t b = 1; b <= buckets; ++b) ends[b] += ends[b - 1];
  for (std::size_t i = 0; i < n; ++i)
    scratch[ends[digit.of(a[i])]++] = a[i];  // ends[b] becomes the end of bucket b
  std::copy_n(scratch, n, a);
  std::size_t begin = 0;
  for (std::size_t b = 0; b < buckets; ++b) {
    if (ends[b] - begin > 1) sort_range(a + begin, scratch + begin, ends[b] - begin);
    begin = ends[b];
  }
}

/// The first round on several threads: each counts and scatters its part of the input into buckets common to
/// all.
class FirstRound {
 public:
  FirstRound(mesh::PageVector<OnCurve>& items, mesh::PageVector<OnCurve>& scratch, Digit digit,
             unsigned threads)
      : items_(items), scratch_(scratch), digit_(digit), threads_(threads), next_(threads) {}

  void run() {
    on_threads(threads_, [this](unsigned i) { count(i); });
    place();
    on_threads(threads_, [this](unsigned i) { scatter(i); });
    on_threads(threads_, [this](unsigned i) { finish(i); });
  }

 private:
  std::size_t begin(unsigned i) const { return part_begin(items_.size(), i, threads_); }

  void count(unsigned thread) {
    next_[thread].fill(0);
    for (std::size_t i = begin(thread); i < begin(thread + 1); ++i) ++next_[thread][digit_.of(items_[i])];
  }

  void place() {
    std::uint32_t sum = 0;
    for (std::size_t b = 0; b < kMaxBuckets; ++b) {
      starts_[b] = sum;
      for (auto& next : next_) {
        const std::uint32_t own = next[b];
        next[b] = sum;
        sum += own;
      }
    }
    starts_[kMaxBuckets] = sum;
  }

  void scatter(unsigned thread) {
    for (std::size_t i = begin(thread); i < begin(thread + 1); ++i)
      scratch_[next_[thread][digit_.of(items_[i])]++] = items_[i];
  }

  /// Sorts the buckets that begin in this thread's part.
  void finish(unsigned thread) {
    for (std::size_t b = 0; b < kMaxBuckets; ++b) {
      if (starts_[b] < begin(thread) || starts_[b] >= begin(thread + 1)) continue;
      sort_range(scratch_.data() + starts_[b], items_.data() + starts_[b], starts_[b + 1] - starts_[b]);
    }
  }

  mesh::PageVector<OnCurve>& items_;
  mesh::PageVector<OnCurve>& scratch_;
  const Digit digit_;
  const unsigned threads_;
  std::vector<std::array<std::uint32_t, kMaxBuckets>> next_;
  std::array<std::uint32_t, kMaxBuckets + 1> starts_{};
};

HilbertCurve curve_through(std::span<const Point> points, unsigned threads) {
  struct Extent {
    Point low, high;
  };
  std::vector<Extent> extents(threads, {points[0], points[0]});
  on_threads(threads, [&](unsigned thread) {
    auto [low, high] = extents[thread];
    for (std::size_t i = part_begin(points.size(), thread, threads);
         i < part_begin(points.size(), thread + 1, threads); ++i) {
      low = {std::min(low.x, points[i].x), std::min(low.y, points[i].y)};
      high = {std::max(high.x, points[i].x), std::max(high.y, points[i].y)};
    }
    extents[thread] = {low, high};
  });
  auto [low, high] = extents[0];
  for (const Extent& e : extents) {
    low = {std::min(low.x, e.low.x), std::min(low.y, e.low.y)};
    high = {std::max(high.x, e.high.x), std::max(high.y, e.high.y)};
  }
  return {low, high};
}

mesh::PageVector<OnCurve> sorted_by_key(std::span<const Point> points, const HilbertCurve& curve, int shift,
                                        unsigned threads) {
  mesh::PageVector<OnCurve> items(points.size()), scratch(points.size());
  on_threads(threads, [&](unsigned thread) {
    for (std::size_t i = part_begin(points.size(), thread, threads);
         i < part_begin(points.size(), thread + 1, threads); ++i) {
      items[i] = {static_cast<std::uint32_t>(curve.index(points[i]) >> shift), static_cast<std::uint32_t>(i)};
    }
  });
  const std::uint32_t differ = differing_bits(items.data(), items.size());
  if (differ == 0) return items;
  FirstRound(items, scratch, choose_digit(differ, items.size()), threads).run();
  return scratch;
}

/// Sorts points with one key by the rest of their positions, which fits another.
void refine(std::span<const Point> points, const HilbertCurve& curve, std::span<OnCurve> run) {
  const std::uint32_t key = run[0].key;
  for (OnCurve& item : run) item.key = static_cast<std::uint32_t>(curve.index(points[item.index]));
  std::sort(run.begin(), run.end(), before);
  for (OnCurve& item : run) item.key = key;
}

}  // namespace

mesh::PageVector<OnCurve> hilbert_sorted(std::span<const Point> points, unsigned threads) {
  if (points.empty()) return {};
  const HilbertCurve curve = curve_through(points, threads);
  const int shift = std::max(0, curve.index_bits() - kKeyBits);
  auto items = sorted_by_key(points, curve, shift, threads);
  std::size_t begin = 0;
  for (std::size_t i = 1; shift > 0 && i <= items.size(); ++i) {
    if (i < items.size() && items[i].key == items[begin].key) continue;
    if (i - begin > 1) refine(points, curve, std::span(items).subspan(begin, i - begin));
    begin = i;
  }
  return items;
}

}  // namespace tin::delaunay
