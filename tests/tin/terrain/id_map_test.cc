#include "tin/terrain/id_map.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/support/point_sets.h"

namespace {

using tin::mesh::kNone;
using tin::mesh::VertexSlot;
using tin::terrain::IdMap;
using tin::terrain::VertexId;

std::map<std::uint64_t, std::uint32_t> contents(const IdMap& map) {
  std::map<std::uint64_t, std::uint32_t> out;
  for (auto id = map.first_from(VertexId(0)); id; id = map.first_from(VertexId(id->value() + 1))) {
    out[id->value()] = map.slot_of(*id)->value();
    EXPECT_EQ(map.id_of(*map.slot_of(*id)), *id);
  }
  return out;
}

TEST(IdMapTest, AgreesWithAnOrderedMapThroughBindingUnbindingAndRenumbering) {
  support::Random random(support::seed());
  SCOPED_TRACE("TINSMITH_SEED=" + std::to_string(support::seed()));
  IdMap map;
  std::map<std::uint64_t, std::uint32_t> expected;
  std::vector<std::uint32_t> free;
  for (std::uint32_t slot = 1; slot <= 3000; ++slot) free.push_back(slot);
  for (int step = 0; step < 20000; ++step) {
    if (!free.empty() && random() % 2 == 0) {
      const std::uint64_t id = 1 + random() % 20000;
      if (expected.contains(id)) continue;
      std::swap(free[random() % free.size()], free.back());
      map.bind(VertexId(id), VertexSlot(free.back()));
      expected[id] = free.back();
      free.pop_back();
    } else if (!expected.empty()) {
      auto it = expected.lower_bound(random() % 20000);
      if (it == expected.end()) it = expected.begin();
      map.unbind(VertexId(it->first));
      free.push_back(it->second);
      expected.erase(it);
    }
  }
  ASSERT_EQ(contents(map), expected);
  ASSERT_EQ(map.size(), expected.size());
  tin::mesh::Renumbering moved;
  moved.vertices.assign(3001, VertexSlot(kNone));
  std::uint32_t next = 1;
  for (auto& [id, slot] : expected) {
    moved.vertices[slot] = VertexSlot(next);
    slot = next++;
  }
  map.renumber(moved);
  EXPECT_EQ(contents(map), expected);
}

TEST(IdMapTest, IdsBeyond32BitsAreKeptWhole) {
  IdMap map;
  map.bind(VertexId(7), VertexSlot(1));
  map.bind(VertexId(0x1'0000'0007), VertexSlot(2));
  map.bind(VertexId(8), VertexSlot(9));
  map.bind(VertexId(0xffff'ffff), VertexSlot(3));
  const std::map<std::uint64_t, std::uint32_t> all{{7, 1}, {8, 9}, {0xffff'ffff, 3}, {0x1'0000'0007, 2}};
  EXPECT_EQ(contents(map), all);
  map.unbind(VertexId(0x1'0000'0007));
  map.bind(VertexId(9), VertexSlot(2));
  EXPECT_EQ(map.id_of(VertexSlot(2)), VertexId(9)) << "the upper half of the slot's former id is gone";
}

}  // namespace
