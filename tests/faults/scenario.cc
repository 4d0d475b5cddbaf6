#include "tests/faults/scenario.h"

#include <cstdlib>
#include <iostream>
#include <random>

#include "tin/codec/change.h"
#include "tin/mesh/validate.h"

namespace tests::faults {

using server::app::Catalogue;
using server::app::InsertAt;
using server::app::RequestKey;
using server::app::Tin;
using server::app::VertexId;
using server::app::WorldEdit;
using tin::terrain::Terrain;

namespace {

Terrain small_terrain() {
  std::vector<tin::terrain::Placement> placements;
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 10; ++x) placements.push_back({{x * 1000, y * 1000}, double(x + y)});
  }
  return *Terrain::build({}, placements, tin::terrain::Duplicates::kReject);
}

std::string fault_in(const Terrain& terrain) {
  return tin::mesh::validate(terrain.mesh()).value_or("");
}

}  // namespace

int rounds(const char* variable, int usual) {
  const char* given = std::getenv(variable);
  return given != nullptr ? std::atoi(given) : usual;
}

std::uint64_t chosen_seed() {
  const char* given = std::getenv("TINSMITH_SEED");
  const std::uint64_t seed = given != nullptr ? std::strtoull(given, nullptr, 10) : std::random_device{}();
  std::cout << "TINSMITH_SEED=" << seed << std::endl;
  return seed;
}

Scenario::Scenario(const std::filesystem::path& folder, const server::store::SqliteOptions& options) {
  auto store = server::store::open_sqlite_store(folder, options);
  if (!store) throw std::runtime_error(store.error().message);
  auto catalogue = Catalogue::open(std::move(*store), {});
  if (!catalogue) throw std::runtime_error(catalogue.error().message);
  catalogue_ = std::move(*catalogue);
  auto found = catalogue_->find("t");
  if (!found) {
    found = catalogue_->create({"t", "T", small_terrain(), tin::terrain::Duplicates::kReplace, std::nullopt, {}});
  }
  if (!found) throw std::runtime_error(found.error().message);
  tin_ = *found;
  revision_ = tin_->revision();
  digest_ = tin_->summary().digest;
}

bool Scenario::note(const tin::base::Result<server::app::Edited>& edited) {
  if (!edited) return false;
  if (edited->revision > revision_) {
    revision_ = edited->revision;
    digest_ = tin_->summary().digest;
  }
  if (acknowledged_) acknowledged_(edited->revision);
  return true;
}

bool Scenario::edit_once() {
  const double at = 0.25 + 0.001 * ++edits_;
  const std::vector<WorldEdit> edits{InsertAt{at, 0.5, double(edits_)},
                                     tin::terrain::SetZ{VertexId(1 + edits_ % 90U), 1000.0 + edits_},
                                     server::app::MoveTo{VertexId(95), 8.0 + at, 8.5}};
  return note(tin_->edit(edits, {}));
}

void Scenario::make_and_delete_another() {
  const auto made = catalogue_->create(
      {"other", "Other", small_terrain(), tin::terrain::Duplicates::kReplace, std::nullopt, {}});
  if (made) static_cast<void>(catalogue_->remove("other"));
}

void Scenario::run(const std::function<void(std::uint64_t)>& acknowledged) {
  acknowledged_ = acknowledged;
  edit_once();
  const std::vector<WorldEdit> keyed{InsertAt{7.7, 7.7, 5}, tin::terrain::Remove{VertexId(44)}};
  for (int sent = 0; sent < 2; ++sent) note(tin_->edit(keyed, {{}, {}, RequestKey{"key", "request"}}));
  static_cast<void>(tin_->write_checkpoint());
  edit_once();
  make_and_delete_another();
  note(tin_->revert(tin_->revision(), {}));
  static_cast<void>(tin_->rename("Renamed"));
  edit_once();
  static_cast<void>(tin_->write_checkpoint());
  edit_once();
  acknowledged_ = {};
}

std::string Scenario::broken_for_readers() const {
  const auto version = tin_->version();
  if (version.revision != revision_) return "readers see revision " + std::to_string(version.revision);
  if (version.terrain->digest() != digest_) return "readers see another digest";
  return fault_in(*version.terrain);
}

std::string broken_on_disk(const std::filesystem::path& folder, std::uint64_t revision,
                           const std::string& digest) {
  auto store = server::store::open_sqlite_store(folder);
  if (!store) return store.error().message;
  auto state = Tin::load(**store, "t");
  if (!state) return state.error().message;
  if (const std::string fault = fault_in(state->terrain); !fault.empty()) return fault;
  if (state->revision < revision) return "revision " + std::to_string(revision) + " was lost";
  if (state->revision > revision + 1) return "there is a revision that nobody asked for";
  if (state->revision == revision + 1) {
    const auto rows = (*store)->read_journal("t", {.first = state->revision});
    if (!rows || rows->size() != 1) return "the last revision cannot be read";
    const auto change = tin::codec::decode_change(rows->front().record);
    if (!change || !state->terrain.replay(change->inverse())) return "the last revision cannot be taken back";
  }
  return state->terrain.digest() == digest ? "" : "the digest is another";
}

}  // namespace tests::faults
