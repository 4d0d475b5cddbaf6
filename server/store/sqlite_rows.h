// Rows and what they mean: each function is one step within a transaction or a read of the caller.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/files.h"
#include "server/store/sqlite_internal.h"
#include "server/store/store.h"
#include "tin/base/result.h"

namespace server::store {

/// A row of the table tin, and the number of its last revision.
struct Head {
  std::int64_t key = 0;
  TinRecord tin;
  std::uint64_t checkpoint_revision = 0;
  std::uint64_t checkpoint_bytes = 0;
  std::uint64_t last_revision = 0;
  FileReference checkpoint;  // no name: it stands in rows
  FileReference source;
};

/// A checkpoint on its way into the store: a file that is there already, or bytes for a row.
struct NewCheckpoint {
  FileReference file;
  std::string_view bytes;
};

tin::base::Error no_such_tin(std::string_view id);
tin::base::Error damaged(std::string_view tin, const std::string& what);

/// Errors: kNotFound.
tin::base::Result<Head> read_head(Database& database, std::string_view tin);
tin::base::Result<std::vector<TinRecord>> read_tins(Database& database);
/// The names of all files that rows name, ascending.
tin::base::Result<std::vector<std::string>> read_file_names(Database& database);

/// Errors: kConflict.
tin::base::Result<void> insert_tin(Database& database, const TinRecord& tin, std::uint64_t revision,
                                   const NewCheckpoint& checkpoint, const FileReference& source);
/// Errors: kConflict when `revision` is not within what the TIN has.
tin::base::Result<void> replace_checkpoint(Database& database, const Head& head, std::uint64_t revision,
                                           const NewCheckpoint& checkpoint);
/// A checkpoint that stands in rows.
tin::base::Result<std::string> read_checkpoint_rows(Database& database, const Head& head);

/// Adds one entry and counts its revision in `head`. Errors: kConflict.
tin::base::Result<void> insert_entry(Database& database, Head& head, const Entry& entry);
tin::base::Result<std::vector<JournalRow>> read_rows(Database& database, const Head& head,
                                                     const JournalRange& range);
tin::base::Result<JournalExtent> read_extent(Database& database, const Head& head);
tin::base::Result<void> trim_rows(Database& database, const Head& head, const Retention& kept);

tin::base::Result<std::optional<Answer>> read_answer(Database& database, const Head& head,
                                                     std::string_view key);
tin::base::Result<void> trim_answer_rows(Database& database, std::int64_t before_ms, std::uint64_t most);

tin::base::Result<void> upsert_job(Database& database, const JobRow& job);
tin::base::Result<std::vector<JobRow>> read_jobs(Database& database);

}  // namespace server::store
