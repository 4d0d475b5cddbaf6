// Batches: building, insertion and removal of many vertices at a time, in the order that memory likes best.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>

#include "tin/delaunay/bulk.h"
#include "tin/delaunay/hilbert_sort.h"
#include "tin/delaunay/threads.h"
#include "tin/delaunay/triangulation.h"

namespace tin::delaunay {

using exact::Point;
using mesh::kNone;
using mesh::Mesh;
using mesh::TriangleSlot;
using mesh::VertexSlot;

namespace {

constexpr std::size_t kBetweenReports = 4096;
constexpr std::size_t kAhead = 4;    // how many operations ahead memory is asked for, per dependent load
constexpr std::size_t kWorthAThread = 20000;  // points
constexpr std::uint32_t kBitsPerWord = 64;
constexpr std::size_t kTogether = 16;  // stars fetched in turns

/// Reports after each 4096th operation. False when it is time to stop.
bool go_on(base::Progress* progress, std::size_t done, std::size_t all) {
  if (progress == nullptr || done % kBetweenReports != 0) return true;
  progress->report(static_cast<double>(done) / static_cast<double>(all));
  return !progress->cancelled();
}

/// Brings the stars of the next few vertices to be removed into the caches. A star is walked from triangle to
/// triangle, each a wait for memory; walking many in turns makes them wait together.
class StarFetcher {
 public:
  explicit StarFetcher(const Mesh& mesh) : mesh_(mesh) {}

  /// Fetches slots[i], slots[i + 1], .. and asks for the first triangles of those after them.
  void fetch(std::span<const VertexSlot> slots, std::size_t i) {
    if (mesh_.dimension() < 2) return;
    const auto part = [&](std::size_t begin) { return slots.subspan(std::min(begin, slots.size())).first(
        std::min(kTogether, slots.size() - std::min(begin, slots.size()))); };
    for (const VertexSlot v : part(i + 2 * kTogether)) mesh_.prefetch(v);
    for (const VertexSlot v : part(i + kTogether)) mesh_.prefetch(mesh_.triangle_at(v));
    std::size_t active = 0;
    for (const VertexSlot v : part(i)) around_[active++] = {v, mesh_.triangle_at(v)};
    for (int round = 0; round < kRounds; ++round) {
      for (std::size_t k = 0; k < active; ++k) step(around_[k]);
    }
  }

 private:
  static constexpr int kRounds = 6;  // triangles per star; most have about six
  struct Around {
    VertexSlot vertex;
    TriangleSlot triangle;
  };

  void step(Around& at) const {
    const int i = mesh_.index_of(at.triangle, at.vertex);
    mesh_.prefetch(mesh_.twin(at.triangle, i).triangle());
    mesh_.prefetch(mesh_.vertex(at.triangle, mesh::next3(i)));
    at.triangle = mesh_.twin(at.triangle, mesh::next3(i)).triangle();
    mesh_.prefetch(at.triangle);
  }

  const Mesh& mesh_;
  std::array<Around, kTogether> around_;
};

std::vector<VertexSlot> in_slot_order(const Mesh& mesh, std::span<const VertexSlot> slots) {
  std::vector<VertexSlot> order(slots.begin(), slots.end());
  if (slots.size() < mesh.vertex_slots() / kBitsPerWord) {
    std::sort(order.begin(), order.end());
    return order;
  }
  std::vector<std::uint64_t> wanted(mesh.vertex_slots() / kBitsPerWord + 1);
  for (const VertexSlot v : slots)
    wanted[v.value() / kBitsPerWord] |= std::uint64_t{1} << v.value() % kBitsPerWord;
  std::size_t count = 0;
  for (std::uint32_t word = 0; word < wanted.size(); ++word) {
    for (std::uint64_t bits = wanted[word]; bits != 0; bits &= bits - 1) {
      order[count++] = VertexSlot(word * kBitsPerWord + static_cast<std::uint32_t>(std::countr_zero(bits)));
    }
  }
  return order;
}

/// Whether neighbours in this order are much nearer to each other than others, by samples.
bool follows_the_ground(const Mesh& mesh, std::span<const VertexSlot> order) {
  constexpr std::size_t kSamples = 64;
  constexpr std::int64_t kMuch = 8;
  if (order.size() < 2 * kSamples) return true;
  const auto distance = [&](std::size_t i, std::size_t j) {
    const Point p = mesh.point(order[i]), q = mesh.point(order[j]);
    return std::abs(std::int64_t{p.x} - q.x) + std::abs(std::int64_t{p.y} - q.y);
  };
  std::int64_t between_neighbours = 0, between_others = 0;
  for (std::size_t k = 0; k < kSamples; ++k) {
    const std::size_t i = k * (order.size() - 1) / kSamples;
    between_neighbours += distance(i, i + 1);
    between_others += distance(i, (i + order.size() / 2) % order.size());
  }
  return kMuch * between_neighbours < between_others;
}

std::vector<VertexSlot> along_the_curve(const Mesh& mesh, std::span<const VertexSlot> slots) {
  std::vector<Point> points;
  points.reserve(slots.size());
  for (const VertexSlot v : slots) points.push_back(mesh.point(v));
  std::vector<VertexSlot> order;
  order.reserve(slots.size());
  for (const OnCurve& item : hilbert_sorted(points)) order.push_back(slots[item.index]);
  return order;
}

/// Stores points along the curve, equal ones once, on several threads.
class Storing {
 public:
  Storing(std::span<const Point> points, std::vector<VertexSlot>& slots, Mesh& mesh, unsigned threads)
      : points_(points), slots_(slots), mesh_(mesh), threads_(threads), kept_(threads, 0),
        sorted_(hilbert_sorted(points, threads)) {}

  void run() {
    mesh_.begin_bulk(sorted_.size());
    on_threads(threads_, [this](unsigned i) { store(i); });
    std::size_t count = kept_[0];
    for (unsigned i = 1; i < threads_; ++i) {
      if (count != begin(i)) close_gap(i, count);
      count += kept_[i];
    }
    mesh_.begin_bulk(count);
  }

 private:
  Point point(std::size_t i) const { return points_[sorted_[i].index]; }

  /// The first of a part: equal points are all in one.
  std::size_t begin(unsigned part) const {
    std::size_t i = part_begin(sorted_.size(), part, threads_);
    while (i > 0 && i < sorted_.size() && point(i) == point(i - 1)) ++i;
    return i;
  }

  /// Stores a part as if there had been no equal points before.
  void store(unsigned part) {
    const std::size_t first = begin(part), end = begin(part + 1);
    auto next = static_cast<std::uint32_t>(first);
    Point last{};
    for (std::size_t i = first; i < end; ++i) {
      if (i + 4 * kAhead < end) __builtin_prefetch(&points_[sorted_[i + 4 * kAhead].index]);
      const Point p = point(i);
      if (i == first || p != last) mesh_.set_point(VertexSlot(++next), p);
      slots_[sorted_[i].index] = VertexSlot(next);
      last = p;
    }
    kept_[part] = next - first;
  }

  /// Moves a part down to behind the first `count` vertices.
  void close_gap(unsigned part, std::size_t count) {
    const std::size_t first = begin(part), end = begin(part + 1);
    for (std::size_t k = 1; k <= kept_[part]; ++k) {
      mesh_.set_point(VertexSlot(static_cast<std::uint32_t>(count + k)),
                      mesh_.point(VertexSlot(static_cast<std::uint32_t>(first + k))));
    }
    for (std::size_t i = first; i < end; ++i) {
      VertexSlot& slot = slots_[sorted_[i].index];
      slot = VertexSlot(static_cast<std::uint32_t>(slot.value() - (first - count)));
    }
  }

  std::span<const Point> points_;
  std::vector<VertexSlot>& slots_;
  Mesh& mesh_;
  unsigned threads_;
  std::vector<std::size_t> kept_;  // by part, its different points
  mesh::PageVector<OnCurve> sorted_;
};

}  // namespace

bool Triangulation::insert_many(std::span<const Point> points, std::vector<VertexSlot>& slots,
                                base::Progress* progress, unsigned threads) {
  slots.assign(points.size(), VertexSlot(kNone));
  const bool done = mesh().vertex_count() == 0 ? build(points, slots, progress, threads)
                                               : insert_more(points, slots, progress);
  base_.forget_fresh();
  return done;
}

bool Triangulation::build(std::span<const Point> points, std::vector<VertexSlot>& slots,
                          base::Progress* progress, unsigned threads) {
  if (points.empty()) return true;
  threads =
      static_cast<unsigned>(std::clamp<std::size_t>(points.size() / kWorthAThread, 1, std::max(threads, 1U)));
  Mesh& mesh = base_.mutable_mesh();
  mesh = Mesh();
  Storing(points, slots, mesh, threads).run();
  const auto prepare_location = [&] {
    hierarchy_.build(mesh);
    grid_.lay_out(mesh, mesh.vertex_slots() - 1);
  };
  if (!build_bulk(mesh, threads, progress, prepare_location)) return false;
  grid_.fill(mesh);
  return true;
}

/// Along the Hilbert curve, each walk from the grid's hint or from the last vertex, whichever should be
/// nearer.
bool Triangulation::insert_more(std::span<const Point> points, std::vector<VertexSlot>& slots,
                                base::Progress* progress) {
  const auto sorted = hilbert_sorted(points);
  const std::size_t count = sorted.size();
  std::size_t done = 0;
  VertexSlot last{kNone};
  // A batch that dwarfs the mesh goes in rounds, as in bulk building.
  for (const std::size_t stride : {std::size_t{64}, std::size_t{8}, std::size_t{1}}) {
    if (stride > 1 && count < mesh().vertex_count() * stride / 8) continue;
    for (std::size_t i = 0; i < count; i += stride) {
      const std::uint32_t index = sorted[i].index;
      if (slots[index].value() != kNone) continue;
      const bool is_coherent = last.value() != kNone && count / stride * 16 > mesh().vertex_count();
      if (!is_coherent) fetch_for_insertion(points, sorted, i);
      last = slots[index] = (is_coherent ? insert_near(points[index], last) : insert(points[index])).vertex;
      if (!go_on(progress, ++done, count)) return false;
    }
  }
  return true;
}

/// Asks for what the insertions after the i-th will touch: a cell of the grid, then its triangle, then what
/// is around that.
void Triangulation::fetch_for_insertion(std::span<const Point> points, std::span<const OnCurve> order,
                                        std::size_t i) const {
  if (i + 3 * kAhead < order.size()) grid_.prefetch_cell(points[order[i + 3 * kAhead].index]);
  if (i + 2 * kAhead < order.size()) {
    const TriangleSlot t = grid_.hint(points[order[i + 2 * kAhead].index]);
    if (t.value() < mesh().triangle_slots()) mesh().prefetch(t);
  }
  if (i + kAhead < order.size()) {
    const TriangleSlot t = grid_.hint(points[order[i + kAhead].index]);
    if (t.value() >= mesh().triangle_slots() || !mesh().is_alive(t)) return;
    for (int k = 0; k < 3; ++k) {
      mesh().prefetch_point(mesh().vertex(t, k));
      mesh().prefetch(mesh().twin(t, k).triangle());
    }
  }
}

/// In the order of their slots where that follows the ground, as it does in a mesh that was built or
/// compacted; else along the curve, which takes longer to find.
bool Triangulation::remove_many(std::span<const VertexSlot> slots, base::Progress* progress) {
  std::vector<VertexSlot> order = in_slot_order(mesh(), slots);
  if (!follows_the_ground(mesh(), order)) order = along_the_curve(mesh(), order);
  return remove_in_order(order, progress);
}

bool Triangulation::remove_in_order(std::span<const VertexSlot> slots, base::Progress* progress) {
  StarFetcher fetcher(mesh());
  for (std::size_t i = 0; i < slots.size(); ++i) {
    if (i % kTogether == 0) fetcher.fetch(slots, i);
    remove(slots[i]);
    if (!go_on(progress, i + 1, slots.size())) return false;
  }
  base_.forget_fresh();
  return true;
}

mesh::Renumbering Triangulation::compact() {
  std::vector<VertexSlot> alive;
  alive.reserve(mesh().vertex_count());
  for (std::uint32_t i = 1; i < mesh().vertex_slots(); ++i) {
    if (mesh().is_alive(VertexSlot(i))) alive.emplace_back(i);
  }
  mesh::Renumbering moved = base_.mutable_mesh().renumber(along_the_curve(mesh(), alive));
  hierarchy_.renumber(moved.vertices);
  grid_.rebuild(mesh());
  base_.forget_fresh();
  return moved;
}

}  // namespace tin::delaunay
