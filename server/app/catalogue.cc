#include "server/app/catalogue.h"

#include <chrono>
#include <new>
#include <random>

#include "server/obs/log.h"

namespace server::app {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

std::int64_t now_ms() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

namespace {

constexpr std::chrono::seconds kSweepEvery{2};
constexpr std::chrono::minutes kForgetEvery{10};

/// 60 random bits in letters and digits.
std::string make_up_id() {
  std::random_device device;
  std::string id = "tin-";
  for (int i = 0; i < 12; ++i) id += "0123456789abcdefghijkmnpqrstuvwx"[device() % 32];
  return id;
}

tin::base::Error broken(const store::TinRecord& record, const tin::base::Error& cause) {
  return error(cause.code, "TIN \"" + record.id + "\" cannot be loaded: " + cause.message);
}

}  // namespace

Result<std::unique_ptr<Catalogue>> Catalogue::open(std::unique_ptr<store::Store> store,
                                                   const LimitConfig& limits, const HistoryConfig& history,
                                                   const std::filesystem::path& scratch) {
  std::unique_ptr<Catalogue> catalogue(new Catalogue(std::move(store), limits, history, scratch));
  auto records = catalogue->store_->list();
  if (!records) return records.error();
  for (const store::TinRecord& record : *records) {
    if (auto loaded = catalogue->load(record); !loaded) return broken(record, loaded.error());
  }
  catalogue->sweeper_ =
      std::jthread([self = catalogue.get()](const std::stop_token& stop) { self->sweep(stop); });
  return catalogue;
}

/// Now and then frees the versions that no page will ask for any more, brings checkpoints forward, and
/// forgets what is older than has to be kept.
void Catalogue::sweep(const std::stop_token& stop) {
  std::mutex unused;
  auto answers_due = std::chrono::steady_clock::now();
  while (!stop.stop_requested()) {
    try {
      sweep_once(stop);
      if (std::chrono::steady_clock::now() >= answers_due) {
        answers_due = std::chrono::steady_clock::now() + kForgetEvery;
        forget_answers();
      }
    } catch (const std::bad_alloc&) {  // there may be memory the next time
    }
    std::unique_lock lock(unused);
    stopping_.wait_for(lock, stop, kSweepEvery, [] { return false; });
  }
}

void Catalogue::sweep_once(const std::stop_token& stop) {
  for (const auto& tin : list()) {
    tin->drop_expired();
    if (tin->steps_since_checkpoint() >= static_cast<std::uint64_t>(history_.checkpoint_steps)) keep_up(*tin);
    if (stop.stop_requested()) return;
  }
}

/// The journal holds everything, so failing is no loss: the next sweep tries again.
void Catalogue::keep_up(Tin& tin) {
  const auto start = std::chrono::steady_clock::now();
  auto done = tin.write_checkpoint();
  if (done) {
    done = store_->trim_journal(tin.id(), {static_cast<std::uint64_t>(history_.revisions),
                                           static_cast<std::uint64_t>(history_.bytes)});
  }
  if (!done) {
    if (done.error().code != Code::kNotFound)  // else it was deleted meanwhile
      obs::log_warning("checkpoint_failed", {{"tin", tin.id()}, {"message", done.error().message}});
    return;
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  obs::log_info("checkpoint", {{"tin", tin.id()}, {"seconds", took.count()}});
}

void Catalogue::forget_answers() {
  const std::int64_t kept_ms = history_.key_hours * 3'600'000;
  const auto done = store_->trim_answers(now_ms() - kept_ms, static_cast<std::uint64_t>(history_.keys));
  if (!done) obs::log_warning("trim_failed", {{"message", done.error().message}});
}

Result<void> Catalogue::load(const store::TinRecord& record) {
  auto state = Tin::load(*store_, record.id);
  if (!state) return state.error();
  obs::log_info("tin_loaded", {{"tin", record.id},
                               {"vertices", state->terrain.vertex_count()},
                               {"revision", state->revision},
                               {"digest", state->terrain.digest()}});
  tins_[record.id] =
      std::make_shared<Tin>(std::move(*state), *store_, static_cast<std::size_t>(limits_.vertices_per_tin));
  return {};
}

std::uint64_t Catalogue::held_bytes() const {
  std::uint64_t bytes = 0;
  for (const auto& tin : list()) bytes += tin->held_bytes();
  return bytes;
}

std::vector<std::shared_ptr<Tin>> Catalogue::list() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::shared_ptr<Tin>> out;
  out.reserve(tins_.size());
  for (const auto& [id, tin] : tins_) out.push_back(tin);
  return out;
}

Result<std::shared_ptr<Tin>> Catalogue::find(std::string_view id) const {
  const std::lock_guard lock(mutex_);
  const auto found = tins_.find(id);
  if (found == tins_.end()) return error(Code::kNotFound, "There is no TIN \"" + std::string(id) + "\".");
  return found->second;
}

Result<void> Catalogue::check_room(const std::optional<std::string>& id) const {
  const std::lock_guard lock(mutex_);
  return check_room_locked(id);
}

Result<void> Catalogue::check_room_locked(const std::optional<std::string>& id) const {
  if (id && (tins_.contains(*id) || being_created_.contains(*id))) {
    return error(Code::kConflict, "There is a TIN \"" + *id + "\" already.");
  }
  if (tins_.size() + being_created_.size() >= static_cast<std::size_t>(limits_.tins)) {
    return error(Code::kTooMany, "This server holds at most " + std::to_string(limits_.tins) + " TINs.");
  }
  return {};
}

Result<std::shared_ptr<Tin>> Catalogue::create(NewTin tin) {
  if (tin.terrain.vertex_count() > static_cast<std::size_t>(limits_.vertices_per_tin)) {
    return error(Code::kTooLarge,
                 "A TIN may have at most " + std::to_string(limits_.vertices_per_tin) + " vertices.");
  }
  // Its caller has it in memory already; without room for it it goes again.
  if (auto room = memory_.check(estimated_bytes(tin.terrain)); !room) return room.error();
  const std::string id = tin.id.value_or(make_up_id());
  const std::string checkpoint = Tin::encode(tin.terrain, tin.duplicates, tin.open_resolution, 1);
  {
    const std::lock_guard lock(mutex_);
    if (auto room = check_room_locked(id); !room) return room.error();
    being_created_.insert(id);
  }
  TinState state{{id, tin.title.empty() ? id : tin.title, now_ms()},
                 std::move(tin.terrain),
                 tin.duplicates,
                 tin.open_resolution,
                 1};
  const auto stored = store_->create_tin(state.record, state.revision, checkpoint, tin.source);
  const std::lock_guard lock(mutex_);
  being_created_.erase(id);
  if (!stored) return stored.error();
  auto made =
      std::make_shared<Tin>(std::move(state), *store_, static_cast<std::size_t>(limits_.vertices_per_tin));
  tins_[id] = made;
  return made;
}

Result<void> Catalogue::remove(std::string_view id) {
  const auto tin = find(id);
  if (!tin) return tin.error();
  if (auto retired = (*tin)->retire(); !retired) return retired;
  const std::lock_guard lock(mutex_);
  tins_.erase(tins_.find(id));  // still there: as long as it is, create() refuses the id
  return {};
}

}  // namespace server::app
