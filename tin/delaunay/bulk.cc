#include "tin/delaunay/bulk.h"

#include <algorithm>
#include <array>
#include <vector>

#include "tin/delaunay/cavity.h"
#include "tin/delaunay/threads.h"
#include "tin/exact/predicates.h"

namespace tin::delaunay {
namespace {

using exact::Point;
using mesh::HalfEdge;
using mesh::kInfinite;
using mesh::Mesh;
using mesh::TriangleSlot;
using mesh::VertexSlot;

constexpr std::uint32_t kStride = 8;
constexpr std::uint32_t kFirstStride = kStride * kStride;
constexpr std::uint32_t kBetweenReports = 4096;
constexpr std::uint32_t kAhead = 64;

TriangleSlot first_slot(VertexSlot v) { return TriangleSlot(2 * v.value() - 2); }
TriangleSlot second_slot(VertexSlot v) { return TriangleSlot(2 * v.value() - 1); }

class Builder {
 public:
  Builder(Mesh& mesh, base::Progress* progress, const std::function<void()>& meanwhile)
      : mesh_(mesh), progress_(progress), meanwhile_(meanwhile) {}

  bool run(unsigned threads) {
    if (!make_first_triangle()) {
      make_line();
      if (meanwhile_) meanwhile_();
      return true;
    }
    const bool done = insert_all(threads);
    if (done) mesh_.end_bulk(std::array{first_slot(first_[2]), second_slot(first_[2])});
    return done;
  }

 private:
  std::uint32_t count() const { return mesh_.vertex_slots() - 1; }

  bool make_first_triangle();
  void make_line();
  bool insert_all(unsigned threads);
  bool insert_first_round();
  bool insert_left(std::span<const VertexSlot> left);
  bool insert_in_territory(unsigned thread, unsigned threads, std::vector<VertexSlot>& left);
  template <class Owner>
  bool insert(Cavity& cavity, VertexSlot v, VertexSlot next, TriangleSlot& start, const Owner& owner);
  bool pause(bool reports);
  void fetch(std::uint32_t i, std::uint32_t end) const;

  bool is_in_first_triangle(VertexSlot v) const { return v == first_[0] || v == first_[1] || v == first_[2]; }

  Mesh& mesh_;
  base::Progress* progress_;
  const std::function<void()>& meanwhile_;
  std::array<VertexSlot, 3> first_{};
  std::uint32_t inserted_ = 0;  // as reported: by the first thread
  double speed_ = 1;            // what each insertion of the first thread stands for
};

/// The first two vertices and the first that is not in line with them, counter-clockwise. False when all are
/// collinear.
bool Builder::make_first_triangle() {
  if (count() < 3) return false;
  const VertexSlot a(1), b(2);
  VertexSlot c(3);
  const auto turn = [&](VertexSlot v) {
    return exact::orientation(mesh_.point(a), mesh_.point(b), mesh_.point(v));
  };
  while (turn(c) == 0) {
    if (c.value() == count()) return false;
    c = VertexSlot(c.value() + 1);
  }
  first_ = {a, b, c};
  std::array<VertexSlot, 3> corner = first_;
  if (turn(c) < 0) std::swap(corner[0], corner[1]);
  const TriangleSlot inner = first_slot(a);
  const std::array<TriangleSlot, 3> outer{second_slot(a), first_slot(b), second_slot(b)};
  // outer[i] is (infinite, corner[i - 1], corner[i + 1]), across the inner triangle's edge opposite to
  // corner[i].
  mesh_.write_triangle(inner,
                       {corner, {HalfEdge(outer[0], 0), HalfEdge(outer[1], 0), HalfEdge(outer[2], 0)}});
  for (int i = 0; i < 3; ++i) {
    const auto next = static_cast<std::size_t>(mesh::next3(i)),
               previous = static_cast<std::size_t>(mesh::prev3(i));
    mesh_.write_triangle(outer[static_cast<std::size_t>(i)],
                         {{kInfinite, corner[previous], corner[next]},
                          {HalfEdge(inner, i), HalfEdge(outer[previous], 2), HalfEdge(outer[next], 1)}});
    mesh_.set_triangle_at(corner[static_cast<std::size_t>(i)], inner);
  }
  mesh_.set_triangle_at(kInfinite, outer[0]);
  return true;
}

void Builder::make_line() {
  std::vector<TriangleSlot> none;
  for (std::uint32_t t = 0; t < mesh_.triangle_slots(); ++t) none.emplace_back(t);
  mesh_.end_bulk(none);
  auto& line = mesh_.mutable_line();
  for (std::uint32_t v = 1; v <= count(); ++v) line.emplace_back(v);
  std::sort(line.begin(), line.end(),
            [this](VertexSlot a, VertexSlot b) { return mesh_.point(a) < mesh_.point(b); });
}

/// False when it is time to stop.
bool Builder::pause(bool reports) {
  if (progress_ == nullptr) return true;
  if (reports) progress_->report(std::min(1.0, speed_ * inserted_ / count()));
  return !progress_->cancelled();
}

/// Asks for what was made at the i-th vertex in an earlier round, or will be.
void Builder::fetch(std::uint32_t i, std::uint32_t end) const {
  if (i >= end) return;
  mesh_.prefetch(VertexSlot(i));
  mesh_.prefetch(first_slot(VertexSlot(i)));
}

/// Inserts `v`, walking from `start`, which then becomes a good place to walk to `next` from. False when the
/// owner may not.
template <class Owner>
bool Builder::insert(Cavity& cavity, VertexSlot v, VertexSlot next, TriangleSlot& start, const Owner& owner) {
  const Point p = mesh_.point(v), q = next.value() <= count() ? mesh_.point(next) : p;
  const Stop stop = walk(mesh_, p, finite_start(mesh_, start), owner);
  if (stop.kind == Stop::Kind::kGaveUp || !cavity.carve(mesh_, p, stop, owner)) return false;
  start = cavity.fill(mesh_, v, first_slot(v), second_slot(v),
                      {std::int64_t{q.x} - p.x, std::int64_t{q.y} - p.y});
  return true;
}

bool Builder::insert_all(unsigned threads) {
  bool goes_on = true;
  on_threads(meanwhile_ ? std::min(threads, 2U) : 1, [&](unsigned i) {
    if (i == 0) goes_on = insert_first_round();
    if (meanwhile_ && i + 1 == std::min(threads, 2U)) meanwhile_();
  });
  if (!goes_on) return false;
  speed_ = threads;
  std::vector<std::vector<VertexSlot>> left(threads);
  std::vector<char> done(threads);
  on_threads(threads, [&](unsigned i) { done[i] = insert_in_territory(i, threads, left[i]) ? 1 : 0; });
  for (unsigned i = 0; i < threads; ++i) {
    if (done[i] == 0 || !insert_left(left[i])) return false;
  }
  return true;
}

bool Builder::insert_first_round() {
  Cavity cavity;
  TriangleSlot start = mesh_.triangle_at(first_[0]);
  for (std::uint32_t i = 1; i <= count(); i += kFirstStride) {
    if (is_in_first_triangle(VertexSlot(i))) continue;
    insert(cavity, VertexSlot(i), VertexSlot(i + kFirstStride), start, Everywhere{});
    if (++inserted_ % kBetweenReports == 0 && !pause(true)) return false;
  }
  return true;
}

/// Inserts what a thread has put off: near each other, along the border of its territory.
bool Builder::insert_left(std::span<const VertexSlot> left) {
  Cavity cavity;
  TriangleSlot start = mesh_.triangle_at(first_[0]);
  for (std::size_t i = 0; i < left.size(); ++i) {
    insert(cavity, left[i], left[i + 1 == left.size() ? i : i + 1], start, Everywhere{});
    if (++inserted_ % kBetweenReports == 0 && !pause(true)) return false;
  }
  return true;
}

bool Builder::insert_in_territory(unsigned thread, unsigned threads, std::vector<VertexSlot>& left) {
  // Whole strides, so that the first vertex of each territory is there already.
  const auto begin = [&](unsigned i) {
    return i == threads ? count() + 1
                        : 1 + static_cast<std::uint32_t>(part_begin(count(), i, threads)) / kFirstStride *
                                  kFirstStride;
  };
  const Territory territory{begin(thread), begin(thread + 1)};
  if (territory.begin == territory.end) return true;  // what begins there is somebody else's
  Cavity cavity;
  TriangleSlot start = mesh_.triangle_at(VertexSlot(territory.begin));
  std::uint32_t done = 0;
  for (const std::uint32_t stride : {kStride, 1U}) {
    for (std::uint32_t i = territory.begin; i < territory.end; i += stride) {
      fetch(i + kAhead * stride, territory.end);
      if ((i - 1) % (stride * kStride) == 0 || is_in_first_triangle(VertexSlot(i))) continue;
      const VertexSlot v(i), next(i + stride);
      if (threads == 1) {
        insert(cavity, v, next, start, Everywhere{});
      } else if (!insert(cavity, v, next, start, territory)) {
        // The territory need not be convex: the walk may have left it. Near on the curve is a vertex of the
        // first round.
        start = mesh_.triangle_at(VertexSlot(i - (i - 1) % kFirstStride));
        if (!insert(cavity, v, next, start, territory)) left.emplace_back(i);
      }
      if (++done % kBetweenReports != 0) continue;
      if (thread == 0) inserted_ += kBetweenReports;
      if (!pause(thread == 0)) return false;
    }
  }
  return true;
}

}  // namespace

bool build_bulk(Mesh& mesh, unsigned threads, base::Progress* progress,
                const std::function<void()>& meanwhile) {
  return Builder(mesh, progress, meanwhile).run(threads);
}

}  // namespace tin::delaunay
