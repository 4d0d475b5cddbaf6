#include "server/cli/check.h"

#include <cstdio>
#include <vector>

#include "server/app/tin.h"
#include "server/store/backup.h"
#include "server/store/sqlite_store.h"
#include "tin/codec/change.h"
#include "tin/mesh/validate.h"

namespace server::cli {

using tin::base::Result;

namespace {

constexpr std::size_t kReadBytes = std::size_t{16} << 20;

void say(const std::string& line) {
  std::printf("%s\n", line.c_str());
}

int fail(const tin::base::Error& error, int status) {
  std::fprintf(stderr, "tinsmith: %s\n", error.message.c_str());
  return status;
}

/// Everything that is kept of the past, from the newest revision back.
std::string fault_in_journal(store::Store& store, const std::string& id) {
  const auto extent = store.journal_extent(id);
  if (!extent) return extent.error().message;
  for (std::uint64_t first = extent->first; first != 0 && first <= extent->last;) {
    const auto rows = store.read_journal(id, {.first = first, .most_bytes = kReadBytes});
    if (!rows) return rows.error().message;
    if (rows->empty() || rows->front().revision != first)
      return "revision " + std::to_string(first) + " is missing";
    for (const store::JournalRow& row : *rows) {
      const auto change = tin::codec::decode_change(row.record);
      if (!change) return "revision " + std::to_string(row.revision) + ": " + change.error().message;
    }
    first = rows->back().revision + 1;
  }
  return "";
}

/// The checkpoint's digest is compared when it is decoded, each step of the journal when it is replayed.
std::string fault_in_tin(store::Store& store, const std::string& id, std::string& summary) {
  const auto state = app::Tin::load(store, id);
  if (!state) return state.error().message;
  if (const auto fault = tin::mesh::validate(state->terrain.mesh())) return *fault;
  if (const std::string fault = fault_in_journal(store, id); !fault.empty()) return fault;
  const auto source =
      store.read_source(id, [](std::string_view, std::uint64_t) { return tin::base::Result<void>(); });
  if (!source) return source.error().message;
  summary = "revision " + std::to_string(state->revision) + ", " +
            std::to_string(state->terrain.vertex_count()) + " vertices, digest " + state->terrain.digest();
  return "";
}

}  // namespace

int check(const std::string& folder) {
  const auto store = store::open_sqlite_store_for_reading(folder);
  if (!store) return fail(store.error(), 2);
  const auto damage = store::find_damage(folder);
  if (!damage) return fail(damage.error(), 2);
  for (const std::string& line : *damage) say("damaged: " + line);
  const auto tins = (*store)->list();
  if (!tins) return fail(tins.error(), 2);
  std::size_t damaged = damage->size();
  for (const store::TinRecord& tin : *tins) {
    std::string summary;
    const std::string fault = fault_in_tin(**store, tin.id, summary);
    say(tin.id + ": " + (fault.empty() ? "sound, " + summary : "damaged: " + fault));
    damaged += fault.empty() ? 0 : 1;
  }
  say(std::to_string(tins->size()) + " TINs, " + std::to_string(damaged) + " damages");
  return damaged == 0 ? 0 : 1;
}

int back_up(const std::string& folder, const std::string& file) {
  const auto done = store::back_up(folder, file);
  return done ? 0 : fail(done.error(), 1);
}

int restore(const std::string& file, const std::string& folder) {
  const auto done = store::restore(file, folder);
  return done ? 0 : fail(done.error(), 1);
}

}  // namespace server::cli
