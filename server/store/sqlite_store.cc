#include "server/store/sqlite_store.h"

#include <array>
#include <mutex>
#include <optional>
#include <utility>

#include "server/store/data_lock.h"
#include "server/store/files.h"
#include "server/store/row_checksum.h"
#include "server/store/sqlite_internal.h"

namespace server::store {
namespace {

using tin::base::Code;
using tin::base::Result;

// Rows stay far below SQLite's limit of 10^9 bytes, and memory for one is small.
constexpr std::size_t kChunkBytes = std::size_t{4} << 20;

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
)sql"};
constexpr std::int64_t kSchemaVersion = kMigrations.size();

tin::base::Error no_such_tin(std::string_view id) {
  return tin::base::error(Code::kNotFound, "no TIN \"" + std::string(id) + "\"");
}

tin::base::Error damaged(std::string_view tin, const std::string& what) {
  return tin::base::error(Code::kStorage, "the store is damaged: TIN \"" + std::string(tin) + "\", " + what);
}

// A row of the table tin, and the number of its last revision.
struct Head {
  std::int64_t key = 0;
  TinRecord tin;
  std::uint64_t checkpoint_revision = 0;
  std::uint64_t checkpoint_bytes = 0;
  std::uint64_t last_revision = 0;
  FileReference source;
};

class SqliteStore : public Store {
 public:
  explicit SqliteStore(DataLock lock) : lock_(std::move(lock)) {}

  Result<void> open(const std::filesystem::path& folder, const SqliteOptions& options);

  Result<void> create_tin(const TinRecord& tin, std::uint64_t revision, std::string_view checkpoint,
                          std::string_view source) override;
  Result<void> update_title(std::string_view tin, std::string_view title) override;
  Result<void> remove_tin(std::string_view tin) override;
  Result<void> append(std::string_view tin, std::uint64_t revision, std::string_view record,
                      const RevisionInfo& info) override;
  Result<void> put_checkpoint(std::string_view tin, std::uint64_t revision,
                              std::string_view checkpoint) override;
  Result<std::vector<TinRecord>> list() override;
  Result<Loaded> load(std::string_view tin) override;
  Result<std::string> load_source(std::string_view tin) override;

 private:
  Result<void> prepare_schema();
  Result<void> open_files(const std::filesystem::path& folder, const SqliteOptions& options);
  Result<void> limit_size(std::int64_t bytes);
  /// Runs `work` in a transaction, which is committed when it succeeds.
  template <class Work>
  Result<void> write(Work work);
  Result<Head> head(std::string_view tin);
  Result<void> insert_tin(const TinRecord& tin, std::uint64_t revision, std::string_view checkpoint,
                          const FileReference& source);
  Result<void> write_chunks(std::int64_t key, std::uint64_t revision, std::string_view checkpoint);
  Result<std::string> read_chunks(const Head& head);
  Result<std::vector<JournalRow>> read_journal(const Head& head);

  DataLock lock_;  // outlives the connection
  std::optional<Files> files_;
  std::mutex mutex_;
  Database database_;
};

Result<void> SqliteStore::open(const std::filesystem::path& folder, const SqliteOptions& options) {
  const std::filesystem::path file = folder / "tinsmith.sqlite3";
  if (auto opened = database_.open(file); !opened.ok()) return opened;
  auto prepared = prepare_schema();
  if (!prepared.ok())
    return tin::base::error(prepared.error().code, file.string() + ": " + prepared.error().message);
  // Only what is ours gets switched to WAL. The WAL of a large checkpoint is cut back afterwards.
  auto set = database_.execute(
      "PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON; PRAGMA journal_size_limit = 67108864;");
  if (!set.ok()) return set;
  if (auto limited = limit_size(options.max_file_bytes); !limited.ok()) return limited;
  return open_files(folder, options);
}

Result<void> SqliteStore::open_files(const std::filesystem::path& folder, const SqliteOptions& options) {
  auto files = Files::open(folder / "files", options.disk ? options.disk : std::make_shared<Disk>());
  if (!files.ok()) return files.error();
  files_ = *std::move(files);
  std::vector<std::string> named;
  Query query = database_.query("SELECT source_file FROM tin WHERE source_file <> '' ORDER BY source_file");
  for (;;) {
    const auto row = query.next();
    if (!row.ok()) return row.error();
    if (!*row) break;
    named.push_back(query.bytes(0));
  }
  files_->remove_all_but(named);
  return {};
}

Result<void> SqliteStore::prepare_schema() {
  const auto version = database_.number("PRAGMA user_version");
  if (!version.ok()) return version.error();
  if (*version > kSchemaVersion) {
    return tin::base::error(Code::kUnsupported, "written by a newer tinsmith: its schema version is " +
                                                    std::to_string(*version) + ", this program knows up to " +
                                                    std::to_string(kSchemaVersion));
  }
  const auto tables = database_.number("SELECT count(*) FROM sqlite_schema");
  if (!tables.ok()) return tables.error();
  if (*version == 0 && *tables > 0) return tin::base::error(Code::kUnsupported, "no database of tinsmith");
  if (auto wal = database_.execute("PRAGMA journal_mode = WAL"); !wal.ok() || *version == kSchemaVersion)
    return wal;
  return write([&]() -> Result<void> {
    for (auto step = static_cast<std::size_t>(*version); step < kMigrations.size(); ++step) {
      if (auto made = database_.execute(kMigrations[step]); !made.ok()) return made;
    }
    return database_.execute(("PRAGMA user_version = " + std::to_string(kSchemaVersion)).c_str());
  });
}

Result<void> SqliteStore::limit_size(std::int64_t bytes) {
  if (bytes <= 0) return {};
  const auto page = database_.number("PRAGMA page_size");
  if (!page.ok()) return page.error();
  const std::int64_t pages = (bytes + *page - 1) / *page;
  return database_.execute(("PRAGMA max_page_count = " + std::to_string(pages)).c_str());
}

template <class Work>
Result<void> SqliteStore::write(Work work) {
  // After a failed write or sync nobody knows what the disk holds, and a later sync may succeed without the
  // pages that were lost: only reading the file anew tells.
  if (database_.disk_failed()) {
    return tin::base::error(Code::kStorage, "the disk failed earlier: nothing is written until a restart");
  }
  Transaction transaction(database_);
  if (!transaction.begun().ok()) return transaction.begun();
  if (Result<void> done = work(); !done.ok()) return done;
  return transaction.commit();
}

Result<Head> SqliteStore::head(std::string_view tin) {
  Query query = database_.query(
      "SELECT key, id, title, created_ms, checkpoint_revision, checkpoint_bytes, max(checkpoint_revision,"
      " coalesce((SELECT max(revision) FROM journal WHERE journal.tin = tin.key), 0)),"
      " source_file, source_bytes, source_crc FROM tin WHERE id = ?");
  const auto row = query.bind_text(tin).next();
  if (!row.ok()) return row.error();
  if (!*row) return no_such_tin(tin);
  return Head{
      query.integer(0), {query.bytes(1), query.bytes(2), query.integer(3)},
      query.natural(4), query.natural(5),
      query.natural(6), {query.bytes(7), query.natural(8), static_cast<std::uint32_t>(query.integer(9))}};
}

Result<void> SqliteStore::write_chunks(std::int64_t key, std::uint64_t revision,
                                       std::string_view checkpoint) {
  for (std::int64_t chunk = 0; !checkpoint.empty(); ++chunk) {
    const std::string_view bytes = checkpoint.substr(0, kChunkBytes);
    Query insert =
        database_.query("INSERT INTO checkpoint(tin, revision, chunk, bytes, crc) VALUES(?, ?, ?, ?, ?)");
    insert.bind(key).bind(revision).bind(chunk).bind_blob(bytes).bind(
        std::int64_t{checksum(revision, chunk, bytes)});
    if (auto done = insert.run(); !done.ok()) return done;
    checkpoint.remove_prefix(bytes.size());
  }
  return {};
}

Result<void> SqliteStore::create_tin(const TinRecord& tin, std::uint64_t revision,
                                     std::string_view checkpoint, std::string_view source) {
  FileReference file;
  if (!source.empty()) {
    auto put = files_->put({source}, "source");
    if (!put.ok()) return put.error();
    file = *std::move(put);
  }
  auto made = [&] {
    const std::lock_guard guard(mutex_);
    return write([&] { return insert_tin(tin, revision, checkpoint, file); });
  }();
  // Where a disk that fails left it open whether the row is there, the file must stay.
  if (!made.ok() && made.error().code == Code::kConflict) files_->remove(file.name);
  return made;
}

Result<void> SqliteStore::insert_tin(const TinRecord& tin, std::uint64_t revision,
                                     std::string_view checkpoint, const FileReference& source) {
  auto present = head(tin.id);
  if (present.ok()) return tin::base::error(Code::kConflict, "there is a TIN \"" + tin.id + "\" already");
  if (present.error().code != Code::kNotFound) return present.error();
  Query insert = database_.query(
      "INSERT INTO tin(id, title, created_ms, checkpoint_revision, checkpoint_bytes, source_file, "
      "source_bytes,"
      " source_crc) VALUES(?, ?, ?, ?, ?, ?, ?, ?)");
  insert.bind_text(tin.id).bind_text(tin.title).bind(tin.created_ms).bind(revision);
  insert.bind(std::uint64_t{checkpoint.size()}).bind_text(source.name).bind(source.bytes);
  if (auto done = insert.bind(std::int64_t{source.crc}).run(); !done.ok()) return done;
  const auto key = database_.number("SELECT last_insert_rowid()");
  if (!key.ok()) return key.error();
  return write_chunks(*key, revision, checkpoint);
}

Result<void> SqliteStore::update_title(std::string_view tin, std::string_view title) {
  const std::lock_guard guard(mutex_);
  return write([&]() -> Result<void> {
    const auto present = head(tin);
    if (!present.ok()) return present.error();
    return database_.query("UPDATE tin SET title = ? WHERE key = ?")
        .bind_text(title)
        .bind(present->key)
        .run();
  });
}

Result<void> SqliteStore::remove_tin(std::string_view tin) {
  const std::lock_guard guard(mutex_);
  std::string source;
  auto removed = write([&]() -> Result<void> {
    const auto present = head(tin);
    if (!present.ok()) return present.error();
    source = present->source.name;
    return database_.query("DELETE FROM tin WHERE key = ?").bind(present->key).run();
  });
  if (removed.ok()) files_->remove(source);
  return removed;
}

Result<void> SqliteStore::append(std::string_view tin, std::uint64_t revision, std::string_view record,
                                 const RevisionInfo& info) {
  const std::uint32_t crc = checksum(JournalRow{revision, std::string(record), info});
  const std::lock_guard guard(mutex_);
  return write([&]() -> Result<void> {
    const auto present = head(tin);
    if (!present.ok()) return present.error();
    if (revision != present->last_revision + 1) {
      return tin::base::error(Code::kConflict, "revision " + std::to_string(revision) +
                                                   " does not follow revision " +
                                                   std::to_string(present->last_revision));
    }
    Query insert = database_.query(
        "INSERT INTO journal(tin, revision, record, time_ms, author, note, crc) VALUES(?, ?, ?, ?, ?, ?, ?)");
    insert.bind(present->key).bind(revision).bind_blob(record).bind(info.time_ms);
    return insert.bind_text(info.author).bind_text(info.note).bind(std::int64_t{crc}).run();
  });
}

Result<void> SqliteStore::put_checkpoint(std::string_view tin, std::uint64_t revision,
                                         std::string_view checkpoint) {
  const std::lock_guard guard(mutex_);
  return write([&]() -> Result<void> {
    const auto present = head(tin);
    if (!present.ok()) return present.error();
    if (revision < present->checkpoint_revision || revision > present->last_revision) {
      return tin::base::error(Code::kConflict, "no checkpoint of revision " + std::to_string(revision) +
                                                   ": it must be one from " +
                                                   std::to_string(present->checkpoint_revision) + " to " +
                                                   std::to_string(present->last_revision));
    }
    Query remove = database_.query("DELETE FROM checkpoint WHERE tin = ?");
    if (auto done = remove.bind(present->key).run(); !done.ok()) return done;
    Query update =
        database_.query("UPDATE tin SET checkpoint_revision = ?, checkpoint_bytes = ? WHERE key = ?");
    update.bind(revision).bind(std::uint64_t{checkpoint.size()}).bind(present->key);
    if (auto done = update.run(); !done.ok()) return done;
    return write_chunks(present->key, revision, checkpoint);
  });
}

Result<std::vector<TinRecord>> SqliteStore::list() {
  const std::lock_guard guard(mutex_);
  Query query = database_.query("SELECT id, title, created_ms FROM tin ORDER BY id");
  std::vector<TinRecord> tins;
  for (;;) {
    const auto row = query.next();
    if (!row.ok()) return row.error();
    if (!*row) return tins;
    tins.push_back({query.bytes(0), query.bytes(1), query.integer(2)});
  }
}

Result<std::string> SqliteStore::read_chunks(const Head& head) {
  Query query = database_.query(
      "SELECT chunk, bytes, crc FROM checkpoint WHERE tin = ? AND revision = ? ORDER BY chunk");
  query.bind(head.key).bind(head.checkpoint_revision);
  std::string checkpoint;
  for (std::int64_t expected = 0;; ++expected) {
    const auto row = query.next();
    if (!row.ok()) return row.error();
    if (!*row) break;
    const std::string bytes = query.bytes(1);
    if (query.integer(0) != expected ||
        query.integer(2) != checksum(head.checkpoint_revision, expected, bytes)) {
      return damaged(head.tin.id, "chunk " + std::to_string(expected) + " of its checkpoint");
    }
    checkpoint += bytes;
  }
  if (checkpoint.size() != head.checkpoint_bytes) return damaged(head.tin.id, "the length of its checkpoint");
  return checkpoint;
}

Result<std::vector<JournalRow>> SqliteStore::read_journal(const Head& head) {
  Query query = database_.query(
      "SELECT revision, record, time_ms, author, note, crc FROM journal WHERE tin = ? AND revision > ?"
      " ORDER BY revision");
  query.bind(head.key).bind(head.checkpoint_revision);
  std::vector<JournalRow> rows;
  for (std::uint64_t expected = head.checkpoint_revision + 1;; ++expected) {
    const auto row = query.next();
    if (!row.ok()) return row.error();
    if (!*row) return rows;
    rows.push_back({query.natural(0), query.bytes(1), {query.integer(2), query.bytes(3), query.bytes(4)}});
    if (rows.back().revision != expected || query.integer(5) != checksum(rows.back())) {
      return damaged(head.tin.id, "revision " + std::to_string(expected) + " of its journal");
    }
  }
}

Result<Loaded> SqliteStore::load(std::string_view tin) {
  const std::lock_guard guard(mutex_);
  auto present = head(tin);
  if (!present.ok()) return std::move(present).error();
  auto checkpoint = read_chunks(*present);
  if (!checkpoint.ok()) return std::move(checkpoint).error();
  auto journal = read_journal(*present);
  if (!journal.ok()) return std::move(journal).error();
  return Loaded{present->tin, present->checkpoint_revision, *std::move(checkpoint), *std::move(journal)};
}

Result<std::string> SqliteStore::load_source(std::string_view tin) {
  std::unique_lock lock(mutex_);
  const auto present = head(tin);
  if (!present.ok()) return present.error();
  lock.unlock();
  if (present->source.name.empty()) return std::string();
  return files_->get(present->source);
}

}  // namespace

Result<std::unique_ptr<Store>> open_sqlite_store(const std::filesystem::path& folder,
                                                 const SqliteOptions& options) {
  Disk plain;
  Disk& disk = options.disk ? *options.disk : plain;
  if (auto made = ensure_folder(folder, disk); !made.ok()) return std::move(made).error();
  auto lock = DataLock::acquire(folder);
  if (!lock.ok()) return std::move(lock).error();
  auto store = std::make_unique<SqliteStore>(*std::move(lock));
  if (auto opened = store->open(folder, options); !opened.ok()) return std::move(opened).error();
  return std::unique_ptr<Store>(std::move(store));
}

}  // namespace server::store
