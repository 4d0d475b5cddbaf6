#include "server/store/sqlite_internal.h"

#include <sqlite3.h>

#include "server/store/store.h"

namespace server::store {
namespace {

using tin::base::Code;
using tin::base::Result;

constexpr int kBusyTimeoutMs = 5000;

int primary(int code) {
  return code & 0xff;
}

/// Also when the index of the log, which is no data, cannot grow.
bool says_full(int code) {
  return primary(code) == SQLITE_FULL || code == SQLITE_IOERR_SHMSIZE;
}

}  // namespace

Database::~Database() {
  for (const auto& [sql, statement] : statements_) sqlite3_finalize(statement);
  sqlite3_close(handle_);
}

Result<void> Database::open(const std::filesystem::path& file, const std::string& vfs, Access access) {
  const int how =
      access == Access::kWrite ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READONLY;
  const int flags = how | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE;
  if (!succeeded(sqlite3_open_v2(file.c_str(), &handle_, flags, vfs.empty() ? nullptr : vfs.c_str())))
    return error();
  if (!succeeded(sqlite3_busy_timeout(handle_, kBusyTimeoutMs))) return error();
  return {};
}

Query Database::query(const char* sql) {
  sqlite3_stmt*& statement = statements_[sql];
  if (statement == nullptr) {
    succeeded(sqlite3_prepare_v3(handle_, sql, -1, SQLITE_PREPARE_PERSISTENT, &statement, nullptr));
  }
  return Query(*this, statement);
}

Result<void> Database::execute(const char* sql) {
  if (!succeeded(sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr))) return error();
  return {};
}

Result<std::int64_t> Database::number(const char* sql) {
  Query asked = query(sql);
  const auto row = asked.next();
  if (!row.ok()) return row.error();
  return *row ? asked.integer(0) : 0;
}

tin::base::Error Database::error() const {
  const int code = sqlite3_extended_errcode(handle_);
  const std::string detail = std::string(sqlite3_errmsg(handle_)) + " (SQLite " + std::to_string(code) + ")";
  if (says_full(code))
    return tin::base::error(Code::kNoSpace, std::string(kDiskFull) + ": " + detail);
  return tin::base::error(Code::kStorage, "the store failed: " + detail);
}

bool Database::succeeded(int code) {
  if (primary(code) == SQLITE_IOERR && !says_full(code)) disk_failed_ = true;
  return code == SQLITE_OK || code == SQLITE_ROW || code == SQLITE_DONE;
}

bool Database::in_transaction() const {
  return sqlite3_get_autocommit(handle_) == 0;
}

void Database::keep_log() {
  const auto note = [](void* self, sqlite3*, const char*, int pages) {
    static_cast<Database*>(self)->log_pages_ = pages;
    return SQLITE_OK;
  };
  sqlite3_wal_hook(handle_, note, this);  // in place of SQLite's own, which would checkpoint
}

void Database::checkpoint_log() {
  int left = 0, done = 0;
  succeeded(sqlite3_wal_checkpoint_v2(handle_, nullptr, SQLITE_CHECKPOINT_PASSIVE, &left, &done));
  log_pages_ = left - done;
}

Query::~Query() {
  if (statement_ == nullptr) return;  // it could not be prepared
  sqlite3_reset(statement_);
  sqlite3_clear_bindings(statement_);
}

Query& Query::bind(std::int64_t number) {
  failed_ = failed_ || !database_.succeeded(sqlite3_bind_int64(statement_, ++bound_, number));
  return *this;
}

Query& Query::bind_text(std::string_view text) {
  const int code = sqlite3_bind_text64(statement_, ++bound_, text.data() == nullptr ? "" : text.data(),
                                       text.size(), SQLITE_STATIC, SQLITE_UTF8);
  failed_ = failed_ || !database_.succeeded(code);
  return *this;
}

Query& Query::bind_blob(std::string_view bytes) {
  const int code = sqlite3_bind_blob64(statement_, ++bound_, bytes.data() == nullptr ? "" : bytes.data(),
                                       bytes.size(), SQLITE_STATIC);
  failed_ = failed_ || !database_.succeeded(code);
  return *this;
}

Result<bool> Query::next() {
  if (statement_ == nullptr || failed_) return database_.error();
  const int code = sqlite3_step(statement_);
  if (!database_.succeeded(code)) return database_.error();
  return code == SQLITE_ROW;
}

Result<void> Query::run() {
  for (;;) {
    const auto row = next();
    if (!row.ok()) return row.error();
    if (!*row) return {};
  }
}

std::int64_t Query::integer(int column) const {
  return sqlite3_column_int64(statement_, column);
}

std::string Query::bytes(int column) const {
  const void* data = sqlite3_column_blob(statement_, column);
  const int size = sqlite3_column_bytes(statement_, column);
  return data == nullptr ? std::string()
                         : std::string(static_cast<const char*>(data), static_cast<std::size_t>(size));
}

Transaction::~Transaction() {
  // SQLite may have rolled back by itself already (disk full); then this one's complaint says nothing new.
  if (begun_.ok() && !committed_) static_cast<void>(database_.execute("ROLLBACK"));
}

Result<void> Transaction::commit() {
  auto result = database_.execute("COMMIT");
  committed_ = result.ok();
  return result;
}

}  // namespace server::store
