// Where TINs outlive the process: one checkpoint per TIN, a journal of revisions after it, and the source that
// it was made from. Bytes only: what they mean is tin/codec's business.
//
//   auto store = open_sqlite_store("/var/lib/tinsmith");
//   (*store)->create_tin({"alps", "The Alps", now_ms}, 1, encode_checkpoint(...));
//   (*store)->append("alps", 2, encode_change(change), {now_ms, "", ""});  // on disk: now answer the client
//   auto loaded = (*store)->load("alps");                                  // after a restart
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tin/base/result.h"

namespace server::store {

/// The message of an Error of a full disk (or a full quota) starts with this; its code is kStorage.
inline constexpr std::string_view kDiskFull = "the disk is full";

/// What is known of a TIN beside its terrain.
struct TinRecord {
  std::string id;
  std::string title;
  std::int64_t created_ms = 0;  // Unix time
  friend bool operator==(const TinRecord&, const TinRecord&) = default;
};

/// Who made a revision, when and why. Times are Unix times.
struct RevisionInfo {
  std::int64_t time_ms = 0;
  std::string author;
  std::string note;
  friend bool operator==(const RevisionInfo&, const RevisionInfo&) = default;
};

/// One revision: how it came from the one before.
struct JournalRow {
  std::uint64_t revision = 0;
  std::string record;
  RevisionInfo info;
  friend bool operator==(const JournalRow&, const JournalRow&) = default;
};

/// All that brings a TIN back: the checkpoint, and the revisions after it, without gaps.
struct Loaded {
  TinRecord tin;
  std::uint64_t checkpoint_revision = 0;
  std::string checkpoint;
  std::vector<JournalRow> journal;
};

/// Thread-safe. Whatever returns success is durable: it survives kill -9 and power loss. Whatever returns an
/// error has changed nothing, save for errors of the disk itself (kStorage), after which a revision that was
/// refused may turn out to be there when the store is opened again.
///
/// Every function may fail with kStorage; other errors are stated with each.
class Store {
 public:
  virtual ~Store() = default;

  /// `source` is kept beside the checkpoint for as long as the TIN is there, and is never written again; an empty
  /// one is none. Errors: kConflict when there is a TIN with this id.
  virtual tin::base::Result<void> create_tin(const TinRecord& tin, std::uint64_t revision,
                                             std::string_view checkpoint, std::string_view source = {}) = 0;
  /// Errors: kNotFound.
  virtual tin::base::Result<void> update_title(std::string_view tin, std::string_view title) = 0;
  /// Removes the TIN with its checkpoint and its journal. Errors: kNotFound.
  virtual tin::base::Result<void> remove_tin(std::string_view tin) = 0;

  /// Adds a revision. Errors: kNotFound; kConflict unless `revision` is the last one's successor.
  virtual tin::base::Result<void> append(std::string_view tin, std::uint64_t revision,
                                         std::string_view record, const RevisionInfo& info) = 0;
  /// Replaces the checkpoint by that of a later revision. The journal before it is kept: revisions are
  /// history. Errors: kNotFound; kConflict when `revision` is older than the checkpoint or newer than the
  /// last revision.
  virtual tin::base::Result<void> put_checkpoint(std::string_view tin, std::uint64_t revision,
                                                 std::string_view checkpoint) = 0;

  /// All TINs, by id.
  virtual tin::base::Result<std::vector<TinRecord>> list() = 0;
  /// Errors: kNotFound; kStorage also when a row is missing or does not match its checksum.
  virtual tin::base::Result<Loaded> load(std::string_view tin) = 0;
  /// The source that the TIN was created with; empty when it has none. Errors: kNotFound; kStorage also when it
  /// is missing or does not match its checksum.
  virtual tin::base::Result<std::string> load_source(std::string_view tin) = 0;
};

}  // namespace server::store
