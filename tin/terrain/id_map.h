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

/// Maps ids to slots through pages of 4,096 ids, dropped when empty: 12 bytes per vertex, O(1) either way, and
/// iteration in the order of the ids. Copies are deep.
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
  VertexId id_of(mesh::VertexSlot slot) const { return id_of_slot_[slot.value()]; }

  /// Requires: `id` is not bound.
  void bind(VertexId id, mesh::VertexSlot slot);
  /// Requires: `id` is bound.
  void unbind(VertexId id);

  /// The smallest bound id >= `from`, for iteration in ascending order; nothing past the last.
  std::optional<VertexId> first_from(VertexId from) const;

 private:
  static constexpr std::size_t kPage = 4096;
  struct Page {
    std::array<std::uint32_t, kPage> slot{};  // 0: unbound
    std::uint32_t bound = 0;
  };
  std::vector<std::unique_ptr<Page>> pages_;
  std::vector<VertexId> id_of_slot_;
  std::size_t size_ = 0;
};

}  // namespace tin::terrain
