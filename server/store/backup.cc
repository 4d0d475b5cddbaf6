#include "server/store/backup.h"

#include <fcntl.h>
#include <unistd.h>

#include <system_error>

#include "server/store/sqlite_internal.h"
#include "server/store/sqlite_rows.h"
#include "server/store/sqlite_schema.h"

namespace server::store {
namespace {

using tin::base::Code;
using tin::base::Result;

constexpr const char* kDatabase = "tinsmith.sqlite3";
constexpr int kAttempts = 5;

constexpr const char* kBackupTables = R"sql(
CREATE TABLE backup_chunk(
  name TEXT NOT NULL,
  chunk INTEGER NOT NULL,
  bytes BLOB NOT NULL,
  PRIMARY KEY(name, chunk));
)sql";

/// All files that rows name.
Result<std::vector<FileReference>> named_files(Database& database) {
  Query query = database.query(
      "SELECT source_file, source_bytes, source_crc FROM tin WHERE source_file <> '' UNION ALL"
      " SELECT checkpoint_file, checkpoint_bytes, checkpoint_crc FROM tin WHERE checkpoint_file <> ''");
  std::vector<FileReference> files;
  for (;;) {
    const auto row = query.next();
    if (!row.ok()) return row.error();
    if (!*row) return files;
    files.push_back({query.bytes(0), query.natural(1), static_cast<std::uint32_t>(query.integer(2))});
  }
}

Result<void> put_in(Database& backup, const Files& files, const FileReference& file) {
  std::int64_t chunk = 0;
  return files.read(file, [&](std::string_view piece) {
    Query insert = backup.query("INSERT INTO backup_chunk(name, chunk, bytes) VALUES(?, ?, ?)");
    return insert.bind_text(file.name).bind(chunk++).bind_blob(piece).run();
  });
}

/// Whether a file is what was put.
Result<void> verify(const Files& files, const FileReference& file) {
  return files.read(file, [](std::string_view) { return Result<void>(); });
}

Result<void> sync_file(const std::filesystem::path& file) {
  Disk disk;
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return tin::base::error(Code::kStorage, "cannot open " + file.string());
  auto synced = disk.sync(descriptor);
  disk.close(descriptor);
  return synced;
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return std::filesystem::absolute(file).lexically_normal().parent_path();
}

/// Brings a finished file under its name, durably.
Result<void> publish(const std::filesystem::path& aside, const std::filesystem::path& file) {
  Disk disk;
  if (auto synced = sync_file(aside); !synced.ok()) return synced;
  if (auto renamed = disk.rename(aside, file); !renamed.ok()) return renamed;
  return disk.sync_folder(folder_of(file));
}

void remove_database(const std::filesystem::path& file) {
  std::error_code ignored;
  for (const char* end : {"", "-journal", "-wal", "-shm"})
    std::filesystem::remove(file.string() + end, ignored);
}

Result<void> copy_database(const std::filesystem::path& from, const std::filesystem::path& to) {
  Database source;
  if (auto opened = source.open(from, {}, Database::Access::kRead); !opened.ok()) return opened;
  if (auto ours = check_schema(source); !ours.ok()) return ours;
  // One statement, and so one moment; servers go on writing meanwhile.
  Query copy = source.query("VACUUM INTO ?");
  return copy.bind_text(to.string()).run();
}

/// Adds the files to a copied database. kNotFound when one was replaced since the copy was made.
Result<void> add_files(const std::filesystem::path& folder, const std::filesystem::path& copy) {
  Database backup;
  if (auto opened = backup.open(copy); !opened.ok()) return opened;
  if (auto made = backup.execute(kBackupTables); !made.ok()) return made;
  const auto named = named_files(backup);
  if (!named.ok()) return named.error();
  auto files = Files::open(folder / "files", std::make_shared<Disk>());
  if (!files.ok()) return files.error();
  for (const FileReference& file : *named) {
    Transaction transaction(backup);
    if (!transaction.begun().ok()) return transaction.begun();
    const auto put = put_in(backup, *files, file);
    if (!put.ok() && !std::filesystem::exists(folder / "files" / file.name))
      return tin::base::error(Code::kNotFound, put.error().message);
    if (!put.ok()) return put;
    if (auto done = transaction.commit(); !done.ok()) return done;
  }
  return {};
}

Result<void> take_out(Database& backup, const FileReference& file, const std::filesystem::path& folder) {
  Disk disk;
  const std::filesystem::path path = folder / file.name;
  const auto descriptor = disk.create(path);
  if (!descriptor.ok()) return descriptor.error();
  Query query = backup.query("SELECT bytes FROM backup_chunk WHERE name = ? ORDER BY chunk");
  query.bind_text(file.name);
  Result<void> done;
  while (done.ok()) {
    const auto row = query.next();
    if (!row.ok()) done = row.error();
    if (!row.ok() || !*row) break;
    done = disk.write(*descriptor, query.bytes(0));
  }
  if (done.ok()) done = disk.sync(*descriptor);
  disk.close(*descriptor);
  return done;
}

Result<void> restore_into(const std::filesystem::path& file, const std::filesystem::path& folder) {
  const std::filesystem::path aside = folder / (std::string(kDatabase) + ".part");
  std::error_code failure;
  std::filesystem::copy_file(file, aside, failure);
  if (failure) return tin::base::error(Code::kStorage, "cannot copy the backup: " + failure.message());
  Disk disk;
  auto files = Files::open(folder / "files", std::make_shared<Disk>());
  if (!files.ok()) return files.error();
  {
    Database database;
    if (auto opened = database.open(aside); !opened.ok()) return opened;
    const auto tables = database.number("SELECT count(*) FROM sqlite_schema WHERE name = 'backup_chunk'");
    if (!tables.ok() || *tables != 1)
      return tin::base::error(Code::kUnsupported, file.string() + " is no backup of tinsmith");
    if (auto ours = check_schema(database); !ours.ok()) return ours;
    const auto named = named_files(database);
    if (!named.ok()) return named.error();
    for (const FileReference& one : *named) {
      if (auto out = take_out(database, one, files->folder()); !out.ok()) return out;
      if (auto checked = verify(*files, one); !checked.ok()) return checked;
    }
    if (auto synced = disk.sync_folder(files->folder()); !synced.ok()) return synced;
    if (auto dropped = database.execute("DROP TABLE backup_chunk; VACUUM"); !dropped.ok()) return dropped;
  }
  return publish(aside, folder / kDatabase);
}

}  // namespace

Result<void> back_up(const std::filesystem::path& folder, const std::filesystem::path& file) {
  if (!std::filesystem::exists(folder / kDatabase))
    return tin::base::error(Code::kNotFound, "there is no store in " + folder.string());
  if (std::filesystem::exists(file))
    return tin::base::error(Code::kConflict, file.string() + " is there already");
  const std::filesystem::path aside = file.string() + ".part";
  Result<void> done;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    remove_database(aside);
    done = copy_database(folder / kDatabase, aside);
    if (done.ok()) done = add_files(folder, aside);
    if (done.ok() || done.error().code != Code::kNotFound) break;
  }
  if (done.ok()) done = publish(aside, file);
  if (!done.ok()) remove_database(aside);
  return done;
}

Result<void> restore(const std::filesystem::path& file, const std::filesystem::path& folder) {
  if (!std::filesystem::exists(file))
    return tin::base::error(Code::kNotFound, "there is no " + file.string());
  std::error_code ignored;
  if (std::filesystem::exists(folder) && !std::filesystem::is_empty(folder, ignored))
    return tin::base::error(Code::kConflict, folder.string() + " is not empty");
  Disk disk;
  if (auto made = ensure_folder(folder, disk); !made.ok()) return made;
  auto done = restore_into(file, folder);
  if (!done.ok()) {  // all of it was made here
    remove_database(folder / (std::string(kDatabase) + ".part"));
    std::filesystem::remove_all(folder / "files", ignored);
  }
  return done;
}

Result<std::vector<std::string>> find_damage(const std::filesystem::path& folder) {
  Database database;
  if (auto opened = database.open(folder / kDatabase, {}, Database::Access::kRead); !opened.ok())
    return opened.error();
  if (auto ours = check_schema(database); !ours.ok()) return ours.error();
  std::vector<std::string> damage;
  {
    Query check = database.query("PRAGMA integrity_check");
    for (;;) {
      const auto row = check.next();
      if (!row.ok()) return row.error();
      if (!*row) break;
      if (const std::string line = check.bytes(0); line != "ok") damage.push_back("the database: " + line);
    }
  }
  const auto lost = database.number("SELECT count(*) FROM journal WHERE tin NOT IN (SELECT key FROM tin)");
  if (!lost.ok()) return lost.error();
  if (*lost > 0) damage.push_back(std::to_string(*lost) + " revisions belong to no TIN");
  const auto tins = read_tins(database);
  if (!tins.ok()) return tins.error();
  for (const TinRecord& tin : *tins) {
    const auto head = read_head(database, tin.id);
    if (!head.ok()) return head.error();
    Query keys = database.query("SELECT key FROM answer WHERE tin = ?");
    keys.bind(head->key);
    for (;;) {
      const auto row = keys.next();
      if (!row.ok()) return row.error();
      if (!*row) break;
      const auto answer = read_answer(database, *head, keys.bytes(0));
      if (!answer.ok()) damage.push_back(answer.error().message);
    }
  }
  return damage;
}

}  // namespace server::store
