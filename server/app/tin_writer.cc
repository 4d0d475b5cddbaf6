// The writer's turn: from a batch of writes to a revision each. See tin.h.
#include <algorithm>
#include <new>
#include <stdexcept>

#include "server/app/tin.h"
#include "server/obs/log.h"
#include "server/obs/metrics.h"
#include "tin/codec/change.h"
#include "tin/query/touched.h"

namespace server::app {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;
using tin::terrain::Terrain;

namespace {

tin::base::Error out_of_memory() {
  return error(Code::kTooMany, "There is not enough memory for this now; nothing was changed.");
}

void log_failure(const std::string& id, const std::exception& failure) noexcept {
  try {
    obs::log_error("write_failed", {{"tin", id}, {"message", failure.what()}});
  } catch (const std::bad_alloc&) {
  }
}

void give_up(Write& write) noexcept {
  try {
    write.outcome = out_of_memory();
  } catch (const std::bad_alloc&) {
    write.outcome = tin::base::Error{Code::kTooMany, {}, {}};
  }
}

Result<void> check_expected(std::span<const std::uint64_t> expected, std::uint64_t present) {
  if (expected.empty() || std::find(expected.begin(), expected.end(), present) != expected.end()) return {};
  return error(Code::kPrecondition, "The TIN is at revision " + std::to_string(present) + " by now.");
}

tin::base::Error other_request() {
  return error(Code::kInvalidValue, "This Idempotency-Key came with another request before.",
               "header:Idempotency-Key");
}

}  // namespace

/// What was applied of a batch, in order, and what the store is to hold of it.
struct Tin::Batch {
  struct Applied {
    Write* write;
    Terrain::Applied applied;
    Edited edited;
  };
  struct Repeated {  // a write that bears the key of one before it
    Write* write;
    std::size_t of;
  };
  std::vector<Applied> applied;
  std::vector<Repeated> repeated;
  std::uint64_t revision = 0;  // after all of them
  std::size_t steps = 0;
  bool twice = true;                    // applied, taken back, and performed again when it is durable
  tin::terrain::Amendments amendments;  // before it, unless it is done twice
};

Result<Edited> Tin::submit(Write& write) {
  writes_.submit(write);
  return std::move(*write.outcome);
}

void Tin::carry_out(std::span<Write* const> writes) {
  try {
    if (!terrain_) reload();
    std::vector<Write*> open;
    for (Write* write : writes) {
      if (!settled_before(*write)) open.push_back(write);
    }
    if (open.size() == 1 && open[0]->prepared) {
      take_over(*open[0]);
    } else if (open.size() == 1 && !open[0]->first_vertices.empty()) {
      fit_and_apply(*open[0]);
    } else if (!open.empty()) {
      carry_out_together(open);
    }
  } catch (const std::exception& exception) {
    log_failure(id(), exception);
  }
  for (Write* write : writes) {
    if (!write->outcome) give_up(*write);
  }
}

/// Whether the write needs no terrain: then its outcome is there.
bool Tin::settled_before(Write& write) {
  if (retired_) {
    write.outcome = error(Code::kNotFound, "The TIN \"" + id() + "\" has been deleted.");
  } else if (write.instead) {
    const auto done = write.instead();
    write.outcome = done ? Result<Edited>(Edited{revision_, {}}) : Result<Edited>(done.error());
  } else if (!terrain_) {
    write.outcome = out_of_memory();
  } else if (write.terms.key) {
    auto before = answered(*write.terms.key);
    if (!before) write.outcome = before.error();
    if (before && *before) write.outcome = std::move(**before);
  }
  return write.outcome.has_value();
}

Result<std::optional<Edited>> Tin::answered(const RequestKey& key) const {
  const auto answer = store_.find_answer(id(), key.key);
  if (!answer) return answer.error();
  if (!*answer) return std::optional<Edited>();
  if ((*answer)->request != key.request) return other_request();
  auto edited = decode_edited((*answer)->bytes);
  if (!edited) return edited.error();
  return std::optional<Edited>(std::move(*edited));
}

void Tin::carry_out_together(std::span<Write* const> writes) {
  Batch batch;
  std::size_t weight = 0;
  for (const Write* write : writes) weight += write->weight;
  batch.twice = weight <= kDoneTwice;
  Lock lock = exclusive();
  std::vector<store::Entry> entries;
  try {
    if (!batch.twice) batch.amendments = terrain_->amendments();
    apply_all(writes, batch);
    for (const Batch::Applied& one : batch.applied)
      entries.push_back(entry_of(*one.write, one.applied.change, one.edited));
    if (batch.twice) take_back(batch);
  } catch (...) {
    reload();  // who knows where it stopped
    throw;
  }
  if (batch.twice) lock.unlock();
  const auto durable = commit(entries);
  try {
    if (durable) {
      if (batch.twice) lock = exclusive();
      perform(batch);
    } else if (!batch.twice) {
      take_back(batch);
      terrain_->set_amendments(std::move(batch.amendments));
    }
  } catch (...) {
    if (!lock.owns_lock()) lock.lock();
    reload();
  }
  publish(batch, durable);
}

/// What is durable, for readers to see when it is published: with mutex_ held.
void Tin::perform(const Batch& batch) {
  for (const Batch::Applied& one : batch.applied) {
    const tin::terrain::Change& change = one.applied.change;
    if (batch.twice) {
      TIN_CHECK(terrain_->replay(change).ok());
      terrain_->amend(change);
    }
    if (change.steps.empty()) continue;
    // An area is seen from the terrain right after its change: not known once others of a batch came after it.
    const bool known = batch.twice || batch.applied.size() == 1;
    changed_areas_.note(one.edited.revision, known ? tin::query::touched_area(*terrain_, change) : std::nullopt);
  }
}

/// Canonicity makes it exact.
void Tin::take_back(const Batch& batch) {
  for (auto one = batch.applied.rbegin(); one != batch.applied.rend(); ++one) terrain_->undo(one->applied);
}

void Tin::apply_all(std::span<Write* const> writes, Batch& batch) {
  batch.revision = revision_;
  for (Write* write : writes) {
    const auto same = std::find_if(batch.applied.begin(), batch.applied.end(), [&](const auto& before) {
      return write->terms.key && before.write->terms.key &&
             before.write->terms.key->key == write->terms.key->key;
    });
    if (same == batch.applied.end()) {
      apply_one(*write, batch);
    } else if (same->write->terms.key->request != write->terms.key->request) {
      write->outcome = other_request();
    } else {
      batch.repeated.push_back({write, static_cast<std::size_t>(same - batch.applied.begin())});
    }
  }
}

void Tin::apply_one(Write& write, Batch& batch) {
  if (auto expected = check_expected(write.terms.expected, batch.revision); !expected) {
    write.outcome = expected.error();
    return;
  }
  auto applied = write.apply(*terrain_);
  if (!applied) {
    write.outcome = applied.error();
    return;
  }
  if (!applied->change.steps.empty() && terrain_->vertex_count() > max_vertices_) {
    terrain_->undo(*applied);
    write.outcome = too_many_vertices();
    return;
  }
  if (!applied->change.steps.empty()) ++batch.revision;
  if (!batch.twice) terrain_->amend(applied->change);
  batch.steps += applied->change.steps.size();
  Edited edited{batch.revision, std::move(applied->ids), std::move(write.areas)};
  batch.applied.push_back({&write, std::move(*applied), std::move(edited)});
}

/// The outcome of all that was applied; readers see it from now on. With mutex_ held, unless nothing is
/// durable.
void Tin::publish(Batch& batch, const Result<void>& durable) {
  if (durable) {
    revision_ = batch.revision;
    steps_since_checkpoint_ += batch.steps;
  }
  for (const Batch::Repeated& repeated : batch.repeated) {
    const Edited& edited = batch.applied[repeated.of].edited;
    try {
      repeated.write->outcome = durable ? Result<Edited>(edited) : Result<Edited>(durable.error());
    } catch (const std::bad_alloc&) {  // the answer is in the store, for when it asks again
    }
  }
  for (Batch::Applied& one : batch.applied) {
    one.write->outcome = durable ? Result<Edited>(std::move(one.edited)) : Result<Edited>(durable.error());
  }
}

/// The first vertices of an open frame go into an empty terrain beside the present one: a refused edit leaves
/// the frame open.
void Tin::fit_and_apply(Write& write) {
  if (auto expected = check_expected(write.terms.expected, revision_); !expected) {
    write.outcome = expected.error();
    return;
  }
  if (!open_resolution_) {  // another came first
    const auto edits = to_lattice(write.first_vertices, terrain_->frame());
    if (!edits) {
      write.outcome = edits.error();
      return;
    }
    write.apply = [&](Terrain& terrain) { return apply(terrain, *edits, write); };
    Write* const one = &write;
    return carry_out_together({&one, 1});
  }
  const auto refuse = [&](const tin::base::Error& why) { write.outcome = why; };
  auto fitted = fit_frame(terrain_->frame(), *open_resolution_, write.first_vertices);
  if (!fitted) return refuse(fitted.error());
  const auto edits = to_lattice(write.first_vertices, (*fitted)->frame());
  if (!edits) return refuse(edits.error());
  const std::string empty = encode(**fitted, duplicates_, std::nullopt, revision_);
  auto applied = apply(**fitted, *edits, write);
  if (!applied) return refuse(applied.error());
  if ((*fitted)->vertex_count() > max_vertices_) {
    return refuse(too_many_vertices());
  }
  if (applied->change.steps.empty()) {
    write.outcome = Edited{revision_, std::move(applied->ids), std::move(write.areas)};
    return;
  }
  (*fitted)->amend(applied->change);
  Edited edited{revision_ + 1, std::move(applied->ids), std::move(write.areas)};
  store::Entry entry = entry_of(write, applied->change, edited);
  entry.checkpoint = empty;
  // Before the commit: nothing may fail after it.
  auto versions_out = std::make_shared<std::atomic<int>>(0);
  expect_past();
  if (auto durable = commit({&entry, 1}); !durable) return refuse(durable.error());
  const Lock lock(mutex_);
  remember_past();
  terrain_ = std::move(*fitted);
  versions_out_ = std::move(versions_out);
  open_resolution_.reset();
  revision_ = edited.revision;
  steps_since_checkpoint_ += applied->change.steps.size();
  write.outcome = std::move(edited);
}

/// A terrain that was made aside takes the present one's place.
void Tin::take_over(Write& write) {
  if (auto expected = check_expected(write.terms.expected, revision_); !expected) {
    write.outcome = expected.error();
    return;
  }
  write.outdated = write.prepared_from != revision_;
  if (write.outdated) {
    write.outcome = error(Code::kConflict, "The TIN has changed meanwhile.");
    return;
  }
  if (write.prepared->vertex_count() > max_vertices_) {
    write.outcome = too_many_vertices();
    return;
  }
  Edited edited{revision_ + 1, {}};
  const store::Entry entry = entry_of(write, write.change, edited);
  // Before the commit: nothing may fail after it.
  auto versions_out = std::make_shared<std::atomic<int>>(0);
  expect_past();
  if (auto durable = commit({&entry, 1}); !durable) {
    write.outcome = durable.error();
    return;
  }
  const Lock lock(mutex_);
  remember_past();
  terrain_ = std::move(write.prepared);
  versions_out_ = std::move(versions_out);
  revision_ = edited.revision;
  steps_since_checkpoint_ += write.change.steps.size();
  write.outcome = std::move(edited);
}

store::Entry Tin::entry_of(const Write& write, const tin::terrain::Change& change,
                           const Edited& edited) const {
  store::Entry entry;
  if (!change.steps.empty())
    entry.row = store::JournalRow{edited.revision, tin::codec::encode_change(change), write.terms.info};
  if (write.terms.key) {
    entry.answer = store::Answer{write.terms.key->key, write.terms.key->request, encode_edited(edited),
                                 write.terms.info.time_ms};
  }
  return entry;
}

Result<void> Tin::commit(std::span<const store::Entry> entries) {
  const bool any = std::any_of(entries.begin(), entries.end(),
                               [](const store::Entry& entry) { return entry.row || entry.answer; });
  if (!any) return {};
  try {
    auto durable = store_.append(id(), entries);
    if (durable) {
      const auto rows = std::count_if(entries.begin(), entries.end(), [](const store::Entry& entry) { return entry.row.has_value(); });
      obs::metrics().revisions.fetch_add(static_cast<std::uint64_t>(rows), std::memory_order_relaxed);
    }
    return durable;
  } catch (const std::bad_alloc&) {  // before it was given to the store
    return out_of_memory();
  }
}

/// The terrain for the writer alone, and no version's. Only the writer changes it, so readers go on while it
/// is copied for those who keep a version.
Tin::Lock Tin::exclusive() {
  Lock lock(mutex_);
  if (versions_out_->load(std::memory_order_acquire) == 0) return lock;
  lock.unlock();
  auto copy = std::make_shared<Terrain>(*terrain_);
  lock.lock();
  replace_terrain(std::move(copy));
  return lock;
}

void Tin::replace_terrain(std::shared_ptr<Terrain> terrain) {
  auto count = std::make_shared<std::atomic<int>>(0);
  expect_past();
  remember_past();
  terrain_ = std::move(terrain);
  versions_out_ = std::move(count);
}

/// Memory ran out within the engine: the terrain is taken from the store, as far as that is durable. If that
/// fails, the next write tries again. Requires: mutex_, or a terrain that is lost already.
void Tin::reload() noexcept {
  terrain_ = nullptr;
  try {
    auto state = load(store_, id());
    if (!state) {
      obs::log_error("reload_failed", {{"tin", id()}, {"message", state.error().message}});
      return;
    }
    replace_terrain(std::make_shared<Terrain>(std::move(state->terrain)));
    obs::log_warning("tin_reloaded", {{"tin", id()}, {"revision", state->revision}});
  } catch (const std::exception& exception) {
    terrain_ = nullptr;
  }
}

tin::base::Error Tin::too_many_vertices() const {
  return error(Code::kTooLarge, "A TIN may have at most " + std::to_string(max_vertices_) + " vertices.");
}

void Tin::require_terrain() const {
  if (!terrain_) throw std::runtime_error("TIN \"" + id() + "\" was lost for want of memory");
}

}  // namespace server::app
