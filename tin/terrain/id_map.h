// Stable vertex ids to slots and back.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "tin/mesh/mesh.h"
#include "tin/terrain/edit.h"

namespace tin::terrain {

/// Maps ids to slots through pages of 4,096 ids, dropped when empty: 8 bytes per vertex where ids are dense (12 once an id
/// passes 2^32), O(1) either way, and iteration in the order of the ids. Copies are deep.
class IdMap {
 public:
  IdMap() = default;
  IdMap(const IdMap& other);
  IdMap& operator=(const IdMap& other);
  IdMap(IdMap&&) noexcept = default;
  IdMap& operator=(IdMap&&) noexcept = default;

  std::size_t size() const { return size_; }
  std::optional<mesh::VertexSlot> slot_of(VertexId id) const;
  /// Requires: a vertex with an id lives in `slot`.
  VertexId id_of(mesh::VertexSlot slot) const {
    const std::uint64_t high = high_of_slot_.empty() ? 0 : high_of_slot_[slot.value()];
    return VertexId(high << 32 | low_of_slot_[slot.value()]);
  }

  /// Requires: `id` is not bound.
  void bind(VertexId id, mesh::VertexSlot slot);
  /// Requires: `id` is bound.
  void unbind(VertexId id);

  /// Follows a renumbering of the slots. Requires: every slot with an id is still one.
  void renumber(const mesh::Renumbering& moved);

  /// The smallest bound id >= `from`, for iteration in ascending order; nothing past the last.
  std::optional<VertexId> first_from(VertexId from) const;

 private:
  static constexpr std::size_t kPage = 4096;
  struct Page {
    std::array<std::uint32_t, kPage> slot{};  // 0: unbound
    std::uint32_t bound = 0;
  };
  std::vector<std::unique_ptr<Page>> pages_;
  void name(mesh::VertexSlot slot, VertexId id);

  std::vector<std::uint32_t> low_of_slot_;   // the lower half of the id, by slot
  std::vector<std::uint32_t> high_of_slot_;  // the upper half; empty as long as it is 0 everywhere
  std::size_t size_ = 0;
};

}  // namespace tin::terrain
