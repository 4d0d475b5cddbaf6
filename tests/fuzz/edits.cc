// Edits from bytes: a terrain and a triangulation live through what the bytes say, and must stay canonical, keep their
// vertices, and come back bit for bit when everything is undone.
//
// The first byte chooses a scale; then each operation is a byte for its kind and three for its place: x, y, and which
// vertex or how many.
#include <array>
#include <cstdio>
#include <map>

#include "tests/fuzz/target.h"
#include "tests/support/mesh_view.h"
#include "tin/base/check.h"
#include "tin/mesh/validate.h"
#include "tin/terrain/terrain.h"

namespace tests::fuzz {

namespace {

using tin::delaunay::Triangulation;
using tin::exact::Point;
using tin::mesh::VertexSlot;
using namespace tin::terrain;

constexpr std::size_t kMaxOperations = 400;  // each is judged, so that this bounds the time of one input

std::string input(char scale, std::initializer_list<std::array<int, 4>> operations) {
  std::string bytes(1, scale);
  for (const auto& operation : operations) {
    for (const int byte : operation) bytes += static_cast<char>(byte);
  }
  return bytes;
}

/// Bytes as operations; zeros when they are at an end.
class Operations {
 public:
  explicit Operations(std::string_view bytes) : bytes_(bytes), scale_(next()) {}

  bool at_end() const { return bytes_.empty() || ++read_ > kMaxOperations; }
  std::uint8_t next() {
    if (bytes_.empty()) return 0;
    const auto byte = static_cast<std::uint8_t>(bytes_.front());
    bytes_.remove_prefix(1);
    return byte;
  }
  Point place() {
    const std::int32_t x = static_cast<std::int8_t>(next()), y = static_cast<std::int8_t>(next());
    const std::int32_t corner = tin::exact::kLatticeHalf - 1;
    switch (scale_ % 4) {
      case 0:
        return {x % 5, y % 5};
      case 1:
        return {x, y};
      case 2:
        return {3'000'000 * x / 4 - 1'000'000 * y, 1'000'000 * x + 3'000'000 * y / 4};
      default:
        return {x < 0 ? x - corner + 127 : corner - x, y < 0 ? y - corner + 127 : corner - y};
    }
  }

 private:
  std::string_view bytes_;
  mutable std::size_t read_ = 0;
  std::uint8_t scale_;
};

void judge(const tin::mesh::Mesh& mesh) {
  if (const auto broken = tin::mesh::validate(mesh)) {
    std::fprintf(stderr, "%s\n", broken->c_str());
    TIN_CHECK(false);
  }
}

Edit read_edit(Operations& operations, std::uint8_t kind, const Terrain& terrain) {
  const Point at = operations.place();
  const std::uint8_t choice = operations.next();
  const auto chosen = terrain.ids().first_from(VertexId(choice % terrain.next_id().value()));
  const VertexId id = chosen.value_or(VertexId(choice));
  if (kind % 8 < 4) return Insert{at, choice / 4.0};
  if (kind % 8 < 6) return Remove{id};
  if (kind % 8 == 6) return Move{id, at};
  return SetZ{id, at.x / 3.0};
}

/// One by one; then everything is taken back.
void live_as_terrain(Operations operations) {
  Terrain terrain{tin::frame::Frame{}};
  std::vector<Change> history;
  std::vector<std::string> digests;
  while (!operations.at_end()) {
    const std::uint8_t kind = operations.next();
    const auto policy = static_cast<Duplicates>(kind / 8 % 6);
    const std::string before = terrain.digest();
    const Edit edit = read_edit(operations, kind, terrain);
    const auto applied = terrain.apply(std::span(&edit, 1), policy);
    if (!applied) {
      TIN_CHECK(terrain.digest() == before);
      continue;
    }
    judge(terrain.mesh());
    digests.push_back(before);
    history.push_back(applied->change);
  }
  const auto fresh = Terrain::restore({}, terrain.vertices_by_id(), terrain.next_id());
  TIN_CHECK(fresh.ok() && fresh->digest() == terrain.digest());
  TIN_CHECK(support::triangles(fresh->mesh()) == support::triangles(terrain.mesh()));
  for (; !history.empty(); history.pop_back(), digests.pop_back()) {
    TIN_CHECK(terrain.replay(history.back().inverse()).ok());
    TIN_CHECK(terrain.digest() == digests.back());
  }
  TIN_CHECK(terrain.vertex_count() == 0);
}

/// In batches, with compaction now and then.
void live_in_batches(Operations operations) {
  Triangulation triangulation;
  std::map<Point, VertexSlot> present;
  while (!operations.at_end()) {
    const std::uint8_t kind = operations.next(), count = operations.next() % 16;
    std::vector<Point> points;
    for (int i = 0; i < count; ++i) points.push_back(operations.place());
    std::vector<VertexSlot> slots;
    if (kind % 4 < 2) {
      TIN_CHECK(triangulation.insert_many(points, slots));
      for (std::size_t i = 0; i < points.size(); ++i) {
        TIN_CHECK(present.emplace(points[i], slots[i]).first->second == slots[i]);
      }
    } else if (kind % 4 == 2) {
      for (const Point p : points) {
        auto it = present.lower_bound(p);
        if (it == present.end()) continue;
        slots.push_back(it->second);
        present.erase(it);
      }
      TIN_CHECK(kind % 8 == 2 ? triangulation.remove_many(slots) : triangulation.remove_in_order(slots));
    } else {
      const auto moved = triangulation.compact();
      for (auto& [p, slot] : present) slot = moved.vertices[slot.value()];
    }
    judge(triangulation.mesh());
    for (const auto& [p, slot] : present) TIN_CHECK(triangulation.mesh().point(slot) == p);
    TIN_CHECK(triangulation.mesh().vertex_count() == present.size());
  }
}

}  // namespace

std::vector<std::string> seeds() {
  std::string square_and_back = input('\1', {{0, 0, 0, 1}, {0, 8, 0, 2}, {0, 8, 8, 3}, {0, 0, 8, 4}, {0, 4, 4, 5},
                                             {4, 0, 0, 5}, {6, 3, 3, 1}, {7, 9, 0, 2}, {4, 0, 0, 1}, {4, 0, 0, 2}});
  std::string line = input('\0', {{0, 0, 0, 1}, {0, 1, 0, 1}, {0, 2, 0, 1}, {0, 3, 0, 1}, {0, 1, 1, 9}, {4, 0, 0, 5}});
  std::string grid(1, '\1'), tilted(1, '\2'), corners(1, '\3');
  for (int i = 0; i < 60; ++i) {
    for (std::string* bytes : {&grid, &tilted, &corners}) {
      for (const int byte : {i % 5 == 4 ? 4 : i % 7 == 6 ? 6 : 0, 10 * (i % 6) - 30, 10 * (i / 6) - 40, i}) {
        *bytes += static_cast<char>(byte);
      }
    }
  }
  return {square_and_back, line, grid, tilted, corners};
}

}  // namespace tests::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const tests::fuzz::Operations operations(tests::fuzz::text(data, size));
  tests::fuzz::live_as_terrain(operations);
  tests::fuzz::live_in_batches(operations);
  return 0;
}
