#include "server/app/revisions.h"

#include <algorithm>
#include <unordered_map>

#include "tin/codec/change.h"

namespace server::app {

using tin::base::Result;
using tin::terrain::Placement;
using tin::terrain::Step;

namespace {

constexpr std::size_t kMostBytes = std::size_t{8} << 20;  // of records in one page

struct Fate {
  std::optional<Placement> before, after;
};

}  // namespace

Result<RevisionSummary> summarise(const store::JournalRow& row) {
  const auto change = tin::codec::decode_change(row.record);
  if (!change) return change.error();
  RevisionSummary summary{row.revision, row.info, 0, 0, 0, {}};
  std::unordered_map<std::uint64_t, Fate> fates;
  bool any = false;
  const auto extend = [&](const std::optional<Placement>& placement) {
    if (!placement) return;
    const auto at = placement->at;
    auto& box = summary.bounds;
    if (!std::exchange(any, true)) box = {at, at};
    box.min = {std::min(box.min.x, at.x), std::min(box.min.y, at.y)};
    box.max = {std::max(box.max.x, at.x), std::max(box.max.y, at.y)};
  };
  for (const Step& step : change->steps) {
    extend(step.before);
    extend(step.after);
    const auto [fate, fresh] = fates.try_emplace(step.id.value(), Fate{step.before, step.after});
    if (!fresh) fate->second.after = step.after;
  }
  for (const auto& [id, fate] : fates) {
    if (fate.before && fate.after) ++summary.changed;
    if (fate.before && !fate.after) ++summary.removed;
    if (!fate.before && fate.after) ++summary.inserted;
  }
  return summary;
}

Result<RevisionPage> read_revisions(store::Store& store, std::string_view tin, store::JournalRange range) {
  const auto extent = store.journal_extent(tin);
  if (!extent) return extent.error();
  range.most_bytes = std::min(range.most_bytes, kMostBytes);
  range.last = std::min(range.last, extent->last);
  const auto rows = store.read_journal(tin, range);
  if (!rows) return rows.error();
  RevisionPage page{{}, extent->last, extent->first};
  for (const store::JournalRow& row : *rows) {
    auto summary = summarise(row);
    if (!summary) return summary.error();
    page.revisions.push_back(std::move(*summary));
  }
  return page;
}

}  // namespace server::app
