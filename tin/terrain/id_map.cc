#include "tin/terrain/id_map.h"

#include "tin/base/check.h"

namespace tin::terrain {

IdMap::IdMap(const IdMap& other) : id_of_slot_(other.id_of_slot_), size_(other.size_) {
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
  if (slot.value() >= id_of_slot_.size()) id_of_slot_.resize(slot.value() + 1);
  id_of_slot_[slot.value()] = id;
}

void IdMap::unbind(VertexId id) {
  auto& page = pages_[id.value() / kPage];
  auto& slot = page->slot[id.value() % kPage];
  TIN_DCHECK(slot != 0);
  slot = 0;
  --size_;
  if (--page->bound == 0) page.reset();
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
