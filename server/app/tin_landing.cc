// What is prepared beside readers and editors when it is large: undoing a revision, and taking a
// simplification in.
#include <algorithm>

#include "server/app/threads.h"
#include "server/app/tin.h"
#include "tin/codec/change.h"
#include "tin/terrain/vertex_set.h"

namespace server::app {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;
using tin::terrain::Change;
using tin::terrain::Terrain;
using tin::terrain::VertexSet;

namespace {

constexpr std::size_t kSmall = 20'000;        // steps that are taken one by one while readers wait
constexpr int kAttempts = 3;                  // to land something large without making editors wait
constexpr std::size_t kReadBytes = 4U << 20;  // of the journal at once
constexpr std::size_t kSearched = 64U << 20;  // of the journal, for who is in the way

Result<Terrain::Applied> replay(Terrain& terrain, const Change& change) {
  Terrain::Applied applied;
  applied.next_id_before = terrain.next_id();
  applied.change = change;
  if (auto done = terrain.replay(change); !done) return done.error();
  return applied;
}

/// What `change` makes of the terrain, built anew. Errors: kConflict at "/i", or without a place when a
/// position is taken.
Result<std::shared_ptr<Terrain>> replayed(const Terrain& terrain, const Change& change) {
  VertexSet set(terrain.vertices_by_id(), terrain.next_id());
  if (auto done = set.replay(change); !done) return done.error();
  auto built = Terrain::restore(terrain.frame(), set.vertices(), set.next_id(), engine_threads());
  if (!built) return error(Code::kConflict, "Another vertex stands where one would return to.");
  built->set_source_grid(terrain.shared_source_grid());
  built->set_amendments(terrain.amendments());
  built->amend(change);
  return std::make_shared<Terrain>(std::move(*built));
}

/// A thinning of `seen` as it fits `now`: mended, if there is somebody who does that.
Result<Fitting> fitted(const Terrain& seen, const Terrain& now, const Thinning& thinning, const Mend& mend) {
  Fitting fitting = fit(seen, now, thinning);
  if (!mend) return fitting;
  const auto mended = mend(now, rebuilt(now, fitting));
  if (!mended) return mended.error();
  return fit(now, now, *mended);
}

std::string name_of(VertexId id) {
  return "vertex " + std::to_string(id.value());
}

}  // namespace

Result<Edited> Tin::revert(std::uint64_t revision, const Terms& terms, MemoryBudget* memory) {
  if (terms.key) {
    auto before = answered(*terms.key);
    if (!before) return before.error();
    if (*before) return std::move(**before);
  }
  const auto rows = store_.read_journal(id(), {.first = revision, .last = revision});
  if (!rows) return rows.error();
  if (rows->empty()) {
    if (revision == 0 || revision > this->revision())
      return error(Code::kNotFound, "The TIN has no revision " + std::to_string(revision) + ".");
    return error(Code::kGone, "Revision " + std::to_string(revision) +
                                  " is the beginning of what is kept: it cannot be undone.");
  }
  const auto change = tin::codec::decode_change(rows->front().record);
  if (!change) return change.error();
  const Change inverse = change->inverse();
  Result<Edited> done = error(Code::kConflict, "");
  if (inverse.steps.size() > kSmall) {
    done = replay_aside(inverse, terms, memory);
  } else {
    const auto added = std::count_if(inverse.steps.begin(), inverse.steps.end(),
                                     [](const tin::terrain::Step& step) { return !step.before; });
    const auto bytes = static_cast<std::uint64_t>(added) * kBytesPerVertex + copy_bytes();
    if (auto room = memory == nullptr ? Result<void>() : memory->check(bytes); !room) return room.error();
    Write write(terms);
    write.weight = inverse.steps.size();
    write.apply = [&](Terrain& terrain) { return replay(terrain, inverse); };
    done = submit(write);
  }
  if (!done && done.error().code == Code::kConflict) return explain_conflict(revision, inverse, done.error());
  return done;
}

Result<Edited> Tin::replay_aside(const Change& change, const Terms& terms, MemoryBudget* memory) {
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const Version base = version();
    std::optional<MemoryBudget::Lease> lease;
    if (memory != nullptr) {
      auto given = memory->lease(estimated_bytes(*base.terrain) + change.steps.size() * kBytesPerVertex);
      if (!given) return given.error();
      lease.emplace(std::move(*given));
    }
    auto prepared = replayed(*base.terrain, change);
    if (!prepared) return prepared.error();
    Write write(terms);
    write.alone = true;
    write.prepared = std::move(*prepared);
    write.prepared_from = base.revision;
    write.change = change;
    auto done = submit(write);
    if (!write.outdated) return done;
  }
  // Editors were quicker each time: now they wait.
  Write write(terms);
  write.weight = change.steps.size();
  write.apply = [&](Terrain& terrain) { return replay(terrain, change); };
  return submit(write);
}

/// Says which vertex stands against undoing `revision`, and since when.
tin::base::Error Tin::explain_conflict(std::uint64_t revision, const Change& inverse,
                                       const tin::base::Error& conflict) {
  std::string why = "Revision " + std::to_string(revision) + " cannot be undone: ";
  const auto index = conflict.where.size() > 1 ? std::stoull(conflict.where.substr(1)) : inverse.steps.size();
  if (index >= inverse.steps.size()) return error(Code::kConflict, why + conflict.message);
  const VertexId vertex = inverse.steps[index].id;
  std::size_t searched = 0;
  for (std::uint64_t first = revision + 1; searched < kSearched;) {
    const auto rows = store_.read_journal(id(), {.first = first, .most_bytes = kReadBytes});
    if (!rows || rows->empty()) break;
    for (const store::JournalRow& row : *rows) {
      const auto change = tin::codec::decode_change(row.record);
      if (!change) break;
      const bool touched = std::any_of(change->steps.begin(), change->steps.end(),
                                       [&](const tin::terrain::Step& step) { return step.id == vertex; });
      if (touched) {
        return error(Code::kConflict, why + name_of(vertex) + " was changed again by revision " +
                                          std::to_string(row.revision) + "; undo that one first.");
      }
      searched += row.record.size() + 64;
    }
    first = rows->back().revision + 1;
  }
  if (inverse.steps[index].before)
    return error(Code::kConflict, why + name_of(vertex) + " has been changed since.");
  why += "another vertex stands where " + name_of(vertex) + " would return to.";
  return error(Code::kConflict, why);
}

Result<Landed> Tin::land(const Version& seen, const Thinning& thinning, const store::RevisionInfo& info,
                         const Mend& mend) {
  const Terms terms{{}, info, std::nullopt};
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const Version base = attempt == 0 ? seen : version();
    const bool edited = base.revision != seen.revision;
    auto fitting = fitted(*seen.terrain, *base.terrain, thinning, edited ? mend : Mend());
    if (!fitting) return fitting.error();
    if (fitting->change.steps.size() <= kSmall && !(edited && mend)) {
      if (!mend) break;
      Terms unless_edited = terms;
      unless_edited.expected = {&base.revision, 1};
      auto landed = land_in_place(seen, thinning, {}, unless_edited);
      if (landed || landed.error().code != Code::kPrecondition) return landed;
      continue;
    }
    Write write(terms);
    write.alone = true;
    write.prepared = std::make_shared<Terrain>(rebuilt(*base.terrain, *fitting));
    write.prepared_from = base.revision;
    write.change = std::move(fitting->change);
    const std::size_t left = write.prepared->vertex_count();
    auto done = submit(write);
    if (write.outdated) continue;
    if (!done) return done.error();
    return Landed{done->revision, left, edited};
  }
  return land_in_place(seen, thinning, mend, terms);
}

/// Few vertices, or editors who were quicker each time: now they wait.
Result<Landed> Tin::land_in_place(const Version& seen, const Thinning& thinning, const Mend& mend,
                                  const Terms& terms) {
  Landed landed;
  bool any = false;
  Write write(terms);
  write.weight = thinning.removed.size() + thinning.inserted.size() + thinning.reset.size();
  write.apply = [&](Terrain& terrain) -> Result<Terrain::Applied> {
    const auto fitting = fitted(*seen.terrain, terrain, thinning, mend);
    if (!fitting) return fitting.error();
    any = !fitting->change.steps.empty();
    auto done = replay(terrain, fitting->change);
    landed.vertices_left = terrain.vertex_count();
    return done;
  };
  const auto done = submit(write);
  if (!done) return done.error();
  landed.revision = done->revision;
  landed.edited_meanwhile = done->revision - (any ? 1 : 0) != seen.revision;
  return landed;
}

}  // namespace server::app
