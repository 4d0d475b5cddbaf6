// The little of SQLite's C API that the store needs, with owners for its handles. Not thread-safe.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>

#include "tin/base/result.h"

struct sqlite3;
struct sqlite3_stmt;

namespace server::store {

class Query;

/// A connection and the statements prepared on it.
class Database {
 public:
  Database() = default;
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  enum class Access { kWrite, kRead };
  /// `vfs` names SQLite's interface to the system; empty: the usual one. For reading, the file must be there,
  /// and is left as it is. Errors: kStorage. To be called once.
  tin::base::Result<void> open(const std::filesystem::path& file, const std::string& vfs = {},
                               Access access = Access::kWrite);

  /// The query of `sql`, a literal, prepared once and used again. At most one Query per literal at a time.
  Query query(const char* sql);
  /// Runs statements without parameters.
  tin::base::Result<void> execute(const char* sql);
  /// The first number that `sql` gives.
  tin::base::Result<std::int64_t> number(const char* sql);

  /// SQLite's present error as ours.
  tin::base::Error error() const;
  /// True once the disk failed under a write: what is on it is uncertain until the file is opened again.
  bool disk_failed() const { return disk_failed_; }
  /// Notes the result of a call; true unless it is an error.
  bool succeeded(int code);
  /// Whether a transaction is open: SQLite takes back the whole of one by itself when the disk is full.
  bool in_transaction() const;

  /// From now on the write-ahead log is brought into the database by checkpoint_log() only.
  void keep_log();
  /// Pages in the log after the last commit.
  int log_pages() const { return log_pages_; }
  /// Brings the log into the database as far as readers allow.
  void checkpoint_log();

 private:
  sqlite3* handle_ = nullptr;
  std::unordered_map<const char*, sqlite3_stmt*> statements_;
  bool disk_failed_ = false;
  int log_pages_ = 0;
};

/// One use of a prepared statement: bind in order, then run() it or step through its rows. Errors while
/// preparing and binding come out of next() and run(). Borrows what is bound until it is destroyed.
class Query {
 public:
  Query(Database& database, sqlite3_stmt* statement) : database_(database), statement_(statement) {}
  ~Query();
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;

  Query& bind(std::int64_t number);
  Query& bind(std::uint64_t number) { return bind(static_cast<std::int64_t>(number)); }
  Query& bind_text(std::string_view text);
  Query& bind_blob(std::string_view bytes);

  /// Steps on: true at a row, false at the end.
  tin::base::Result<bool> next();
  /// Steps to the end.
  tin::base::Result<void> run();

  /// A column of the row.
  std::int64_t integer(int column) const;
  std::uint64_t natural(int column) const { return static_cast<std::uint64_t>(integer(column)); }
  std::string bytes(int column) const;

 private:
  Database& database_;
  sqlite3_stmt* statement_;
  int bound_ = 0;
  bool failed_ = false;
};

/// A transaction: rolled back unless committed.
class Transaction {
 public:
  enum Kind { kWrite, kRead };
  explicit Transaction(Database& database, Kind kind = kWrite)
      : database_(database), begun_(database.execute(kind == kWrite ? "BEGIN IMMEDIATE" : "BEGIN")) {}
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;

  /// Whether it could begin.
  const tin::base::Result<void>& begun() const { return begun_; }
  tin::base::Result<void> commit();

 private:
  Database& database_;
  tin::base::Result<void> begun_;
  bool committed_ = false;
};

}  // namespace server::store
