#include "server/api/edit_place.h"

#include <algorithm>

namespace server::api {

app::Terms EditPlace::terms(std::span<const std::uint64_t> expected, const proto::Remark& remark) const {
  return {expected, {app::now_ms(), remark.author, remark.note}, key};
}

Result<EditPlace> edit_place(Context& context, const Request& request) {
  Slot slot(context.edits);
  if (!slot.taken()) return tin::base::error(tin::base::Code::kTooMany, "Too many edits wait already.");
  auto key = request_key(request);
  if (!key) return key.error();
  return EditPlace{std::move(slot), *std::move(key)};
}

Result<void> room_for_edit(const Context& context, const app::Tin& tin,
                           std::span<const app::WorldEdit> edits) {
  const auto inserted = std::count_if(edits.begin(), edits.end(), [](const app::WorldEdit& one) {
    return std::holds_alternative<app::InsertAt>(one);
  });
  return context.catalogue.memory().check(static_cast<std::uint64_t>(inserted) * app::kBytesPerVertex +
                                          tin.copy_bytes());
}

}  // namespace server::api
