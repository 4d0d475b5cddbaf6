// What clients do to a data folder while things go wrong, and what must be true of the folder afterwards.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/app/catalogue.h"
#include "server/store/sqlite_store.h"

namespace tests::faults {

/// How many of something the test does: `usual`, or what the environment variable says in the long form.
int rounds(const char* variable, int usual);
/// From TINSMITH_SEED, or at random; printed.
std::uint64_t chosen_seed();

/// A store and its one TIN, "t", of 10 x 10 vertices.
class Scenario {
 public:
  /// Makes the folder's store and TIN if they are not there. Throws if it cannot.
  Scenario(const std::filesystem::path& folder, const server::store::SqliteOptions& options);

  /// Edits with and without keys, an edit that is sent twice, an undo, checkpoints, other TINs that come and
  /// go. Calls `acknowledged(revision)` after each success. Errors are part of the game.
  void run(const std::function<void(std::uint64_t)>& acknowledged = {});
  /// One edit; whether it was acknowledged.
  bool edit_once();

  server::app::Tin& tin() { return *tin_; }
  server::store::Store& store() { return catalogue_->store(); }
  std::uint64_t revision() const { return revision_; }
  const std::string& digest() const { return digest_; }

  /// What readers see must be what was acknowledged, and a sound mesh. "" or what is wrong.
  std::string broken_for_readers() const;

 private:
  bool note(const tin::base::Result<server::app::Edited>& edited);
  void make_and_delete_another();

  std::unique_ptr<server::app::Catalogue> catalogue_;
  std::shared_ptr<server::app::Tin> tin_;
  std::function<void(std::uint64_t)> acknowledged_;
  std::uint64_t revision_ = 0;  // the last that was acknowledged
  std::string digest_;          // of it
  int edits_ = 0;
};

/// Opens the folder with nothing failing: TIN "t" must be at the acknowledged revision with its digest, or at
/// the one after it, which was under way, and then taking that back must give the digest. "" or what is
/// wrong.
std::string broken_on_disk(const std::filesystem::path& folder, std::uint64_t revision,
                           const std::string& digest);

}  // namespace tests::faults
