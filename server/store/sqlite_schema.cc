#include "server/store/sqlite_schema.h"

#include <array>
#include <string>

namespace server::store {
namespace {

using tin::base::Code;
using tin::base::Result;

// What leads from each version of the schema to the next: a new store takes all steps, an older one the rest.
constexpr std::array kMigrations = {
    R"sql(
CREATE TABLE tin(
  key INTEGER PRIMARY KEY AUTOINCREMENT,
  id TEXT NOT NULL UNIQUE,
  title TEXT NOT NULL,
  created_ms INTEGER NOT NULL,
  checkpoint_revision INTEGER NOT NULL,
  checkpoint_bytes INTEGER NOT NULL);
CREATE TABLE checkpoint(
  tin INTEGER NOT NULL REFERENCES tin(key) ON DELETE CASCADE,
  revision INTEGER NOT NULL,
  chunk INTEGER NOT NULL,
  bytes BLOB NOT NULL,
  crc INTEGER NOT NULL,
  PRIMARY KEY(tin, revision, chunk));
CREATE TABLE journal(
  tin INTEGER NOT NULL REFERENCES tin(key) ON DELETE CASCADE,
  revision INTEGER NOT NULL,
  record BLOB NOT NULL,
  time_ms INTEGER NOT NULL,
  author TEXT NOT NULL,
  note TEXT NOT NULL,
  crc INTEGER NOT NULL,
  PRIMARY KEY(tin, revision));
)sql",
    // The source of a TIN: a file.
    R"sql(
ALTER TABLE tin ADD COLUMN source_file TEXT NOT NULL DEFAULT '';
ALTER TABLE tin ADD COLUMN source_bytes INTEGER NOT NULL DEFAULT 0;
ALTER TABLE tin ADD COLUMN source_crc INTEGER NOT NULL DEFAULT 0;
)sql",
    // Large checkpoints: files. Answers under idempotency keys, and jobs.
    R"sql(
ALTER TABLE tin ADD COLUMN checkpoint_file TEXT NOT NULL DEFAULT '';
ALTER TABLE tin ADD COLUMN checkpoint_crc INTEGER NOT NULL DEFAULT 0;
CREATE TABLE answer(
  tin INTEGER NOT NULL REFERENCES tin(key) ON DELETE CASCADE,
  key TEXT NOT NULL,
  request BLOB NOT NULL,
  bytes BLOB NOT NULL,
  time_ms INTEGER NOT NULL,
  crc INTEGER NOT NULL,
  PRIMARY KEY(tin, key));
CREATE INDEX answer_by_time ON answer(time_ms);
CREATE TABLE job(
  number INTEGER PRIMARY KEY AUTOINCREMENT,
  id TEXT NOT NULL UNIQUE,
  kind TEXT NOT NULL,
  description TEXT NOT NULL,
  state INTEGER NOT NULL,
  created_ms INTEGER NOT NULL,
  started_ms INTEGER NOT NULL,
  finished_ms INTEGER NOT NULL,
  message TEXT NOT NULL,
  error TEXT NOT NULL,
  error_where TEXT NOT NULL,
  result TEXT NOT NULL);
)sql"};
constexpr std::int64_t kSchemaVersion = kMigrations.size();

Result<std::int64_t> version_of(Database& database) {
  const auto version = database.number("PRAGMA user_version");
  if (!version.ok()) return version;
  if (*version > kSchemaVersion) {
    return tin::base::error(Code::kUnsupported, "written by a newer tinsmith: its schema version is " +
                                                    std::to_string(*version) + ", this program knows up to " +
                                                    std::to_string(kSchemaVersion));
  }
  const auto tables = database.number("SELECT count(*) FROM sqlite_schema");
  if (!tables.ok()) return tables;
  if (*version == 0 && *tables > 0) return tin::base::error(Code::kUnsupported, "no database of tinsmith");
  return version;
}

}  // namespace

std::int64_t schema_version() {
  return kSchemaVersion;
}

Result<void> prepare_schema(Database& database) {
  const auto version = version_of(database);
  if (!version.ok()) return version.error();
  // Only what is ours gets switched to the write-ahead log.
  if (auto wal = database.execute("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL"); !wal.ok())
    return wal;
  if (*version == kSchemaVersion) return {};
  Transaction transaction(database);
  if (!transaction.begun().ok()) return transaction.begun();
  for (auto step = static_cast<std::size_t>(*version); step < kMigrations.size(); ++step) {
    if (auto made = database.execute(kMigrations[step]); !made.ok()) return made;
  }
  const std::string stamp = "PRAGMA user_version = " + std::to_string(kSchemaVersion);
  if (auto stamped = database.execute(stamp.c_str()); !stamped.ok()) return stamped;
  return transaction.commit();
}

Result<void> check_schema(Database& database) {
  const auto version = version_of(database);
  if (!version.ok()) return version.error();
  if (*version == kSchemaVersion) return {};
  return tin::base::error(Code::kUnsupported, "written by an older tinsmith (its schema version is " +
                                                  std::to_string(*version) +
                                                  "): let \"tinsmith serve\" open it once");
}

}  // namespace server::store
