#include "tin/terrain/id_map.h"

#include "tin/base/check.h"

namespace tin::terrain {

IdMap::IdMap(const IdMap& other)
    : low_of_slot_(other.low_of_slot_), high_of_slot_(other.high_of_slot_), size_(other.size_) {
  pages_.reserve(other.pages_.size());
  for (const auto& page : other.pages_) pages_.push_back(page ? std::make_unique<Page>(*page) : nullptr);
}

IdMap& IdMap::operator=(const IdMap& other) {
  if (this != &other) *this = IdMap(other);
  return *this;
}

std::optional<mesh::VertexSlot> IdMap::slot_of(VertexId id) const {
  const std::uint64_t page = id.value() / kPage;
  if (page >= pages_.size() || !pages_[page]) return std::nullopt;
  const std::uint32_t slot = pages_[page]->slot[id.value() % kPage];
  if (slot == 0) return std::nullopt;
  return mesh::VertexSlot(slot);
}

void IdMap::bind(VertexId id, mesh::VertexSlot slot) {
  const std::uint64_t index = id.value() / kPage;
  if (index >= pages_.size()) pages_.resize(index + 1);
  if (!pages_[index]) pages_[index] = std::make_unique<Page>();
  TIN_DCHECK(pages_[index]->slot[id.value() % kPage] == 0);
  pages_[index]->slot[id.value() % kPage] = slot.value();
  ++pages_[index]->bound;
  ++size_;
  name(slot, id);
}

void IdMap::name(mesh::VertexSlot slot, VertexId id) {
  if (slot.value() >= low_of_slot_.size()) low_of_slot_.resize(slot.value() + 1);
  low_of_slot_[slot.value()] = static_cast<std::uint32_t>(id.value());
  const auto high = static_cast<std::uint32_t>(id.value() >> 32);
  if (high == 0 && high_of_slot_.empty()) return;
  if (high_of_slot_.size() < low_of_slot_.size()) high_of_slot_.resize(low_of_slot_.size());
  high_of_slot_[slot.value()] = high;
}

void IdMap::unbind(VertexId id) {
  auto& page = pages_[id.value() / kPage];
  auto& slot = page->slot[id.value() % kPage];
  TIN_DCHECK(slot != 0);
  slot = 0;
  --size_;
  if (--page->bound == 0) page.reset();
}

void IdMap::renumber(const mesh::Renumbering& moved) {
  low_of_slot_ = std::vector<std::uint32_t>(size_ + 1);  // slots have no gaps now
  high_of_slot_ = {};
  for (std::uint64_t index = 0; index < pages_.size(); ++index) {
    if (!pages_[index]) continue;
    for (std::uint64_t i = 0; i < kPage; ++i) {
      std::uint32_t& slot = pages_[index]->slot[i];
      if (slot == 0) continue;
      slot = moved.vertices[slot].value();
      name(mesh::VertexSlot(slot), VertexId(index * kPage + i));
    }
  }
}

std::optional<VertexId> IdMap::first_from(VertexId from) const {
  for (std::uint64_t index = from.value() / kPage; index < pages_.size(); ++index) {
    if (!pages_[index]) continue;
    const std::uint64_t start = index == from.value() / kPage ? from.value() % kPage : 0;
    for (std::uint64_t i = start; i < kPage; ++i) {
      if (pages_[index]->slot[i] != 0) return VertexId(index * kPage + i);
    }
  }
  return std::nullopt;
}

}  // namespace tin::terrain
