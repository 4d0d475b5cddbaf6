// Where TINs outlive the process: a checkpoint per TIN, a journal of revisions, the source that it was made
// from, the answers that were given under idempotency keys, and the jobs. Bytes only: what they mean is
// tin/codec's and the caller's business.
//
//   auto store = open_sqlite_store("/var/lib/tinsmith");
//   (*store)->create_tin({"alps", "The Alps", now_ms}, 1, encode_checkpoint(...));
//   (*store)->append("alps", {{2, encode_change(change), {now_ms, "", ""}}});  // on disk: now answer the
//   client auto loaded = (*store)->load("alps");                                      // after a restart
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/pieces.h"
#include "tin/base/result.h"

namespace server::store {

/// The message of an Error of a full disk (or a full quota) starts with this; its code is kNoSpace.
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

/// What was answered to a request that bore an idempotency key: who sends the key again gets it again.
struct Answer {
  std::string key;
  std::string request;  // a fingerprint: the key may not come with another request
  std::string bytes;
  std::int64_t time_ms = 0;  // Unix time
  friend bool operator==(const Answer&, const Answer&) = default;
};

/// What is made durable together: a revision, the answer to who asked for it, or both.
struct Entry {
  std::optional<JournalRow> row;
  std::optional<Answer> answer;
  /// Replaces the checkpoint, as that of the revision before `row`.
  std::optional<std::string> checkpoint = std::nullopt;
};

/// All that brings a TIN back: the checkpoint, and the revisions after it, without gaps.
struct Loaded {
  TinRecord tin;
  std::uint64_t checkpoint_revision = 0;
  std::string checkpoint;
  std::vector<JournalRow> journal;
};

/// A part of a journal: revisions from `first` to `last`, both included.
struct JournalRange {
  std::uint64_t first = 0;
  std::uint64_t last = UINT64_MAX;
  bool newest_first = false;
  std::size_t most_rows = SIZE_MAX;
  std::size_t most_bytes = SIZE_MAX;  // of records; one row is given in any case
};

/// How far back a journal reaches.
struct JournalExtent {
  std::uint64_t first = 0;  // the oldest revision that is kept; 0: none
  std::uint64_t last = 0;   // the present revision
  std::uint64_t checkpoint = 0;
};

/// What is kept of a journal behind its checkpoint: no more than either bound.
struct Retention {
  std::uint64_t revisions = UINT64_MAX;
  std::uint64_t bytes = UINT64_MAX;  // of records
};

/// A job as it is remembered. Times are Unix times, 0: not yet.
struct JobRow {
  std::string id;
  std::string kind;
  std::string description;
  std::int64_t state = 0;
  std::int64_t created_ms = 0;
  std::int64_t started_ms = 0;
  std::int64_t finished_ms = 0;
  std::string message;
  std::string error;  // what kind of error it met; empty: none
  std::string where;  // of its error
  std::string result;
  friend bool operator==(const JobRow&, const JobRow&) = default;
};

/// Thread-safe. Whatever returns success is durable: it survives kill -9 and power loss. Writers that come at
/// one time share one commit. Whatever returns an error has changed nothing, save for errors of the disk
/// itself (kStorage), after which what was refused may turn out to be there when the store is opened again;
/// the store takes no more writes then, see writable().
///
/// Every function may fail with kStorage, and whatever writes with kNoSpace; other errors are stated with
/// each.
class Store {
 public:
  virtual ~Store() = default;

  /// `source` is kept beside the checkpoint for as long as the TIN is there, and is never written again; an
  /// empty function is none. Errors: kConflict when there is a TIN with this id; those of `source`.
  virtual tin::base::Result<void> create_tin(const TinRecord& tin, std::uint64_t revision,
                                             std::string_view checkpoint, const Pieces& source) = 0;
  /// The same with a source that is there as a whole; an empty one is none.
  tin::base::Result<void> create_tin(const TinRecord& tin, std::uint64_t revision,
                                     std::string_view checkpoint, std::string_view source = {}) {
    if (source.empty()) return create_tin(tin, revision, checkpoint, Pieces());
    return create_tin(tin, revision, checkpoint, [source](const Sink& sink) { return sink(source); });
  }
  /// Errors: kNotFound.
  virtual tin::base::Result<void> update_title(std::string_view tin, std::string_view title) = 0;
  /// Removes the TIN with all that belongs to it. Errors: kNotFound.
  virtual tin::base::Result<void> remove_tin(std::string_view tin) = 0;

  /// Adds revisions and answers, all or none. Errors: kNotFound; kConflict unless each revision is the last
  /// one's successor, or when there is an answer under the key.
  virtual tin::base::Result<void> append(std::string_view tin, std::span<const Entry> entries) = 0;
  /// Replaces the checkpoint by that of a later revision. The journal before it is kept: revisions are
  /// history. Errors: kNotFound; kConflict when `revision` is older than the checkpoint or newer than the
  /// last revision.
  virtual tin::base::Result<void> put_checkpoint(std::string_view tin, std::uint64_t revision,
                                                 std::string_view checkpoint) = 0;
  /// Forgets the oldest revisions, as far as the checkpoint holds what they led to. Errors: kNotFound.
  virtual tin::base::Result<void> trim_journal(std::string_view tin, const Retention& kept) = 0;
  /// Forgets answers given before `before_ms`, and the oldest ones but for `most`.
  virtual tin::base::Result<void> trim_answers(std::int64_t before_ms, std::uint64_t most) = 0;

  /// All TINs, by id.
  virtual tin::base::Result<std::vector<TinRecord>> list() = 0;
  /// Errors: kNotFound; kStorage also when a row is missing or does not match its checksum.
  virtual tin::base::Result<Loaded> load(std::string_view tin) = 0;
  /// Gives the source that the TIN was created with to `sink` as it is read, nothing when it has none;
  /// nothing is known of the bytes before this has returned. Errors: kNotFound; kStorage also when it is
  /// missing or does not match its checksum; the sink's.
  virtual tin::base::Result<void> read_source(std::string_view tin, const MeasuredSink& sink) = 0;
  /// All of it; empty when there is none. Errors: as read_source().
  tin::base::Result<std::string> load_source(std::string_view tin) {
    std::string bytes;
    const auto done = read_source(tin, [&](std::string_view piece, std::uint64_t) -> tin::base::Result<void> {
      bytes += piece;
      return {};
    });
    if (!done) return done.error();
    return bytes;
  }
  /// Errors: kNotFound; kStorage also when a row is missing or does not match its checksum.
  virtual tin::base::Result<std::vector<JournalRow>> read_journal(std::string_view tin,
                                                                  const JournalRange& range) = 0;
  /// Errors: kNotFound.
  virtual tin::base::Result<JournalExtent> journal_extent(std::string_view tin) = 0;
  /// Nothing when none was given under this key. Errors: kNotFound.
  virtual tin::base::Result<std::optional<Answer>> find_answer(std::string_view tin,
                                                               std::string_view key) = 0;

  /// Adds a job, or replaces what is known of it.
  virtual tin::base::Result<void> put_job(const JobRow& job) = 0;
  virtual tin::base::Result<void> remove_job(std::string_view id) = 0;
  /// All jobs, in the order in which they were first put.
  virtual tin::base::Result<std::vector<JobRow>> list_jobs() = 0;

  /// An error once the disk failed under a write: reads go on, writes need a restart.
  virtual tin::base::Result<void> writable() const = 0;
  /// Commits that were made so far, the writes that they held, and how long they took, syncs included; and
  /// how many writes wait now for a commit or for its end.
  struct Counts {
    std::uint64_t commits = 0;
    std::uint64_t writes = 0;
    double seconds = 0;
    std::uint64_t waiting = 0;
  };
  virtual Counts counts() const = 0;
};

}  // namespace server::store
