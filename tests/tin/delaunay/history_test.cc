// Long mixed histories: a million edits of every kind, one by one and in batches, on points that are hard on a triangulation,
// with the judge along the way and CGAL at the end.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <unordered_map>

#include "tests/support/oracle.h"
#include "tests/support/point_sets.h"
#include "tin/delaunay/triangulation.h"
#include "tin/mesh/validate.h"

namespace {

using support::Random;
using tin::delaunay::Triangulation;
using tin::exact::kLatticeHalf;
using tin::exact::Point;
using tin::mesh::VertexSlot;

#ifdef NDEBUG
constexpr std::size_t kEdits = 200'000;  // of each of five kinds of points
#else
constexpr std::size_t kEdits = 20'000;
#endif

std::uint64_t key(Point p) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(p.x)) << 32 | static_cast<std::uint32_t>(p.y);
}

/// A triangulation under edits, and what should be in it.
class History {
 public:
  explicit History(Random& random, std::function<Point()> draw) : random_(random), draw_(std::move(draw)) {}

  std::size_t size() const { return present_.size(); }
  const Triangulation& triangulation() const { return triangulation_; }
  std::span<const Point> points() const { return present_; }

  void insert_one() {
    const Point p = draw_();
    const auto [v, fresh] = triangulation_.insert(p);
    ASSERT_EQ(fresh, !index_.contains(key(p)));
    add(p, v);
  }
  void remove_one() {
    const std::size_t i = random_() % present_.size();
    triangulation_.remove(index_.at(key(present_[i])).slot);
    forget(i);
  }
  void move_one() {
    remove_one();
    insert_one();
  }
  void insert_batch(std::size_t count) {
    std::vector<Point> points(count);
    for (Point& p : points) p = draw_();
    std::vector<VertexSlot> slots;
    ASSERT_TRUE(triangulation_.insert_many(points, slots));
    for (std::size_t i = 0; i < count; ++i) add(points[i], slots[i]);
  }
  void remove_batch(std::size_t count, bool in_order) {
    std::vector<VertexSlot> slots;
    for (std::size_t i = 0; i < count && !present_.empty(); ++i) {
      const std::size_t chosen = random_() % present_.size();
      slots.push_back(index_.at(key(present_[chosen])).slot);
      forget(chosen);
    }
    ASSERT_TRUE(in_order ? triangulation_.remove_in_order(slots) : triangulation_.remove_many(slots));
  }
  void compact() {
    const auto moved = triangulation_.compact();
    for (auto& [k, entry] : index_) entry.slot = moved.vertices[entry.slot.value()];
  }
  /// The judge, and that exactly these points are vertices, under their slots.
  void check() const {
    ASSERT_EQ(tin::mesh::validate(triangulation_.mesh()).value_or(""), "");
    ASSERT_EQ(triangulation_.mesh().vertex_count(), present_.size());
    for (const Point p : present_) ASSERT_EQ(triangulation_.mesh().point(index_.at(key(p)).slot), p);
  }

 private:
  struct Entry {
    VertexSlot slot;
    std::size_t place;  // in present_
  };
  void add(Point p, VertexSlot v) {
    const auto [it, fresh] = index_.emplace(key(p), Entry{v, present_.size()});
    if (fresh) present_.push_back(p);
    ASSERT_EQ(it->second.slot, v);
  }
  void forget(std::size_t i) {
    index_.erase(key(present_[i]));
    if (i + 1 != present_.size()) {
      present_[i] = present_.back();
      index_.at(key(present_[i])).place = i;
    }
    present_.pop_back();
  }

  Random& random_;
  std::function<Point()> draw_;
  Triangulation triangulation_;
  std::vector<Point> present_;
  std::unordered_map<std::uint64_t, Entry> index_;
};

class HistoryTest : public testing::Test {
 protected:
  /// Grows and shrinks in turns: at most a few thousand vertices, now and then hardly any.
  void live_through(std::function<Point()> draw) {
    History history(random_, std::move(draw));
    for (std::size_t done = 0, step = 0; done < kEdits; ++step) {
      const bool grow = history.size() < 4 || random_() % 100 < (done / (kEdits / 10) % 2 == 0 ? 56 : 43);
      const std::size_t batch = step % 97 == 0 ? 1 + random_() % 700 : 0;
      if (step % 5 == 0 && history.size() > 3 && batch == 0) {
        ASSERT_NO_FATAL_FAILURE(history.move_one());
      } else if (grow) {
        ASSERT_NO_FATAL_FAILURE(batch > 0 ? history.insert_batch(batch) : history.insert_one());
      } else {
        ASSERT_NO_FATAL_FAILURE(batch > 0 ? history.remove_batch(batch, step % 2 == 0) : history.remove_one());
      }
      done += std::max<std::size_t>(batch, 1);
      if (step % 20'011 == 0) history.compact();
      if (step % (kEdits / 50) == 0) {
        ASSERT_NO_FATAL_FAILURE(history.check()) << "after " << done << " edits";
      }
    }
    ASSERT_NO_FATAL_FAILURE(history.check());
    EXPECT_EQ(support::triangles(history.triangulation().mesh()), support::cgal_delaunay(history.points()));
    while (history.size() > 0) history.remove_batch(500, false);
    EXPECT_EQ(history.triangulation().mesh().dimension(), -1);
  }

  std::int32_t between(std::int32_t low, std::int32_t high) {
    return std::uniform_int_distribution<std::int32_t>(low, high)(random_);
  }

  Random random_{support::seed()};
  testing::ScopedTrace trace_{__FILE__, __LINE__, "TINSMITH_SEED=" + std::to_string(support::seed())};
};

TEST_F(HistoryTest, OfPointsAllOverTheLattice) {
  live_through([this] {
    return Point{between(-kLatticeHalf, kLatticeHalf - 1), between(-kLatticeHalf, kLatticeHalf - 1)};
  });
}

TEST_F(HistoryTest, OfPointsOneStepApart) {
  live_through([this] { return Point{between(-35, 35), between(-35, 35)}; });
}

TEST_F(HistoryTest, OfATiltedGrid) {
  live_through([this] {
    const std::int32_t u = between(-50, 50), v = between(-50, 50);
    return Point{3'000'000 * u - 4'000'000 * v, 4'000'000 * u + 3'000'000 * v};
  });
}

TEST_F(HistoryTest, OfClustersAtTheLatticesCorners) {
  live_through([this] {
    const std::int32_t low = -kLatticeHalf, high = kLatticeHalf - 1;
    const std::int32_t x = between(0, 20), y = between(0, 20);
    return Point{between(0, 1) == 0 ? low + x : high - x, between(0, 1) == 0 ? low + y : high - y};
  });
}

TEST_F(HistoryTest, OfCirclesLinesAndTheirCentres) {
  const auto circle = support::circle_points(7);
  live_through([this, circle] {
    switch (between(0, 3)) {
      case 0:
        return Point{3 * between(-4000, 4000), 0};
      case 1:
        return Point{between(-3, 3), between(-3, 3)};
      case 2:
        return Point{between(-2000, 2000) * 100, 224'315};
      default:
        return circle[static_cast<std::size_t>(between(0, static_cast<std::int32_t>(circle.size()) - 1))];
    }
  });
}

}  // namespace
