#include "server/store/sqlite_store.h"

#include <mutex>
#include <optional>
#include <utility>

#include "server/store/committer.h"
#include "server/store/data_lock.h"
#include "server/store/files.h"
#include "server/store/sqlite_internal.h"
#include "server/store/sqlite_rows.h"
#include "server/store/sqlite_schema.h"

namespace server::store {
namespace {

using tin::base::Code;
using tin::base::Result;

// Writes go through the committing thread and its connection; reads have one of their own, and see what is
// committed. So no read waits for a sync.
class SqliteStore : public Store {
 public:
  SqliteStore() = default;
  explicit SqliteStore(DataLock lock) : lock_(std::move(lock)) {}

  Result<void> open(const std::filesystem::path& folder, const SqliteOptions& options);
  Result<void> open_for_reading(const std::filesystem::path& folder);

  Result<void> create_tin(const TinRecord& tin, std::uint64_t revision, std::string_view checkpoint,
                          const Pieces& source) override;
  Result<void> update_title(std::string_view tin, std::string_view title) override;
  Result<void> remove_tin(std::string_view tin) override;
  Result<void> append(std::string_view tin, std::span<const Entry> entries) override;
  Result<void> put_checkpoint(std::string_view tin, std::uint64_t revision,
                              std::string_view checkpoint) override;
  Result<void> trim_journal(std::string_view tin, const Retention& kept) override;
  Result<void> trim_answers(std::int64_t before_ms, std::uint64_t most) override;

  Result<std::vector<TinRecord>> list() override;
  Result<Loaded> load(std::string_view tin) override;
  Result<void> read_source(std::string_view tin, const MeasuredSink& sink) override;
  Result<std::vector<JournalRow>> read_journal(std::string_view tin, const JournalRange& range) override;
  Result<JournalExtent> journal_extent(std::string_view tin) override;
  Result<std::optional<Answer>> find_answer(std::string_view tin, std::string_view key) override;

  Result<void> put_job(const JobRow& job) override;
  Result<void> remove_job(std::string_view id) override;
  Result<std::vector<JobRow>> list_jobs() override;

  Result<void> writable() const override;
  Counts counts() const override;

 private:
  Result<void> open_database(const std::filesystem::path& file, const SqliteOptions& options);
  Result<void> limit_size(std::int64_t bytes);
  Result<NewCheckpoint> place(std::string_view checkpoint);
  /// Removes files that a failed write leaves without a row. Where a failing disk left it open whether the
  /// row is there, they stay, and the next start decides.
  void drop_unnamed(const Result<void>& written, std::span<const FileReference> files);
  Result<void> commit(const Committer::Work& work);
  template <class Step>
  Result<void> change(std::string_view tin, Step step);

  std::optional<DataLock> lock_;  // outlives the connections
  std::size_t row_bytes_ = 0;
  std::optional<Files> files_;
  Database writing_;
  std::mutex reading_mutex_;
  Database reading_;
  std::optional<Committer> committer_;  // last: its thread uses the rest; none: only reading
};

Result<void> SqliteStore::open(const std::filesystem::path& folder, const SqliteOptions& options) {
  const std::filesystem::path file = folder / "tinsmith.sqlite3";
  if (auto opened = open_database(file, options); !opened.ok())
    return tin::base::error(opened.error().code, file.string() + ": " + opened.error().message);
  row_bytes_ = options.checkpoint_row_bytes;
  auto files = Files::open(folder / "files", options.disk ? options.disk : std::make_shared<Disk>());
  if (!files.ok()) return files.error();
  files_ = *std::move(files);
  const auto named = read_file_names(reading_);
  if (!named.ok()) return named.error();
  files_->remove_all_but(*named);
  committer_.emplace(writing_);
  return {};
}

Result<void> SqliteStore::open_database(const std::filesystem::path& file, const SqliteOptions& options) {
  if (auto opened = writing_.open(file, options.vfs); !opened.ok()) return opened;
  if (auto prepared = prepare_schema(writing_); !prepared.ok()) return prepared;
  auto set = writing_.execute("PRAGMA foreign_keys = ON; PRAGMA journal_size_limit = 67108864;");
  if (!set.ok()) return set;
  writing_.keep_log();
  if (auto limited = limit_size(options.max_file_bytes); !limited.ok()) return limited;
  if (auto opened = reading_.open(file, options.vfs); !opened.ok()) return opened;
  return reading_.execute("PRAGMA query_only = ON");
}

Result<void> SqliteStore::open_for_reading(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "tinsmith.sqlite3";
  auto opened = reading_.open(file, {}, Database::Access::kRead);
  if (opened.ok()) opened = check_schema(reading_);
  if (!opened.ok())
    return tin::base::error(opened.error().code, file.string() + ": " + opened.error().message);
  auto files = Files::open(folder / "files", std::make_shared<Disk>());
  if (!files.ok()) return files.error();
  files_ = *std::move(files);
  return {};
}

Result<void> SqliteStore::writable() const {
  return committer_ ? committer_->writable() : tin::base::error(Code::kStorage, "opened for reading");
}

Store::Counts SqliteStore::counts() const {
  return committer_ ? committer_->counts() : Counts{};
}

Result<void> SqliteStore::limit_size(std::int64_t bytes) {
  if (bytes <= 0) return {};
  const auto page = writing_.number("PRAGMA page_size");
  if (!page.ok()) return page.error();
  const std::int64_t pages = (bytes + *page - 1) / *page;
  return writing_.execute(("PRAGMA max_page_count = " + std::to_string(pages)).c_str());
}

/// Brings a large checkpoint to disk; a small one goes into a row.
Result<NewCheckpoint> SqliteStore::place(std::string_view checkpoint) {
  if (checkpoint.size() <= row_bytes_) return NewCheckpoint{{}, checkpoint};
  auto file = files_->put([checkpoint](const Sink& sink) { return sink(checkpoint); }, "checkpoint");
  if (!file.ok()) return file.error();
  return NewCheckpoint{*std::move(file), {}};
}

void SqliteStore::drop_unnamed(const Result<void>& written, std::span<const FileReference> files) {
  if (written.ok() || written.error().code == Code::kStorage) return;
  for (const FileReference& file : files) files_->remove(file.name);
}

Result<void> SqliteStore::commit(const Committer::Work& work) {
  if (!committer_) return tin::base::error(Code::kStorage, "the store was opened for reading");
  return committer_->commit(work);
}

/// One write to a TIN: step(database, head). Errors: kNotFound, and those of the step.
template <class Step>
Result<void> SqliteStore::change(std::string_view tin, Step step) {
  return commit([&](Database& database) -> Result<void> {
    auto head = read_head(database, tin);
    if (!head.ok()) return head.error();
    return step(database, *head);
  });
}

Result<void> SqliteStore::create_tin(const TinRecord& tin, std::uint64_t revision,
                                     std::string_view checkpoint, const Pieces& source) {
  std::array<FileReference, 2> files;
  if (source) {
    auto put = files_->put(source, "source");
    if (!put.ok()) return put.error();
    files[0] = *std::move(put);
  }
  const auto placed = place(checkpoint);
  if (!placed.ok()) {
    files_->remove(files[0].name);
    return placed.error();
  }
  files[1] = placed->file;
  auto made =
      commit([&](Database& database) { return insert_tin(database, tin, revision, *placed, files[0]); });
  drop_unnamed(made, files);
  return made;
}

Result<void> SqliteStore::update_title(std::string_view tin, std::string_view title) {
  return change(tin, [&](Database& database, const Head& head) {
    return database.query("UPDATE tin SET title = ? WHERE key = ?").bind_text(title).bind(head.key).run();
  });
}

Result<void> SqliteStore::remove_tin(std::string_view tin) {
  Head removed;
  auto done = change(tin, [&](Database& database, const Head& head) {
    removed = head;
    return database.query("DELETE FROM tin WHERE key = ?").bind(head.key).run();
  });
  if (done.ok()) {
    files_->remove(removed.source.name);
    files_->remove(removed.checkpoint.name);
  }
  return done;
}

Result<void> SqliteStore::append(std::string_view tin, std::span<const Entry> entries) {
  // Few entries bring a checkpoint, and a small one.
  std::string replaced;
  auto done = change(tin, [&](Database& database, Head& head) -> Result<void> {
    for (const Entry& entry : entries) {
      if (entry.checkpoint) {
        replaced = head.checkpoint.name;
        auto put = replace_checkpoint(database, head, head.last_revision, {{}, *entry.checkpoint});
        if (!put.ok()) return put;
      }
      if (auto added = insert_entry(database, head, entry); !added.ok()) return added;
    }
    return {};
  });
  if (done.ok()) files_->remove(replaced);
  return done;
}

Result<void> SqliteStore::put_checkpoint(std::string_view tin, std::uint64_t revision,
                                         std::string_view checkpoint) {
  const auto placed = place(checkpoint);
  if (!placed.ok()) return placed.error();
  std::string replaced;
  auto done = change(tin, [&](Database& database, const Head& head) {
    replaced = head.checkpoint.name;
    return replace_checkpoint(database, head, revision, *placed);
  });
  if (done.ok()) files_->remove(replaced);
  drop_unnamed(done, {&placed->file, 1});
  return done;
}

Result<void> SqliteStore::trim_journal(std::string_view tin, const Retention& kept) {
  return change(tin, [&](Database& database, const Head& head) { return trim_rows(database, head, kept); });
}

Result<void> SqliteStore::trim_answers(std::int64_t before_ms, std::uint64_t most) {
  return commit([&](Database& database) { return trim_answer_rows(database, before_ms, most); });
}

Result<std::vector<TinRecord>> SqliteStore::list() {
  const std::lock_guard guard(reading_mutex_);
  return read_tins(reading_);
}

Result<Loaded> SqliteStore::load(std::string_view tin) {
  for (int attempt = 0;; ++attempt) {
    std::unique_lock lock(reading_mutex_);
    Transaction snapshot(reading_, Transaction::kRead);  // head and rows of one moment
    if (!snapshot.begun().ok()) return snapshot.begun().error();
    const auto head = read_head(reading_, tin);
    if (!head.ok()) return head.error();
    auto journal = read_rows(reading_, *head, {.first = head->checkpoint_revision + 1});
    if (!journal.ok()) return journal.error();
    const std::uint64_t first = journal->empty() ? head->last_revision + 1 : journal->front().revision;
    if (first != head->checkpoint_revision + 1)
      return damaged(tin, "revision " + std::to_string(head->checkpoint_revision + 1) + " of its journal");
    auto checkpoint = head->checkpoint.name.empty() ? read_checkpoint_rows(reading_, *head)
                                                    : Result<std::string>(std::string());
    if (!checkpoint.ok()) return checkpoint.error();
    if (!head->checkpoint.name.empty()) {
      lock.unlock();
      checkpoint = files_->get(head->checkpoint);
      // Another may have taken its place, and removed it, after the row was read.
      if (!checkpoint.ok() && attempt < 3) continue;
      if (!checkpoint.ok()) return checkpoint.error();
    }
    return Loaded{head->tin, head->checkpoint_revision, *std::move(checkpoint), *std::move(journal)};
  }
}

Result<void> SqliteStore::read_source(std::string_view tin, const MeasuredSink& sink) {
  std::unique_lock lock(reading_mutex_);
  const auto head = read_head(reading_, tin);
  if (!head.ok()) return head.error();
  lock.unlock();
  if (head->source.name.empty()) return {};
  return files_->read(head->source, [&](std::string_view piece) { return sink(piece, head->source.bytes); });
}

Result<std::vector<JournalRow>> SqliteStore::read_journal(std::string_view tin, const JournalRange& range) {
  const std::lock_guard guard(reading_mutex_);
  const auto head = read_head(reading_, tin);
  if (!head.ok()) return head.error();
  return read_rows(reading_, *head, range);
}

Result<JournalExtent> SqliteStore::journal_extent(std::string_view tin) {
  const std::lock_guard guard(reading_mutex_);
  const auto head = read_head(reading_, tin);
  if (!head.ok()) return head.error();
  return read_extent(reading_, *head);
}

Result<std::optional<Answer>> SqliteStore::find_answer(std::string_view tin, std::string_view key) {
  const std::lock_guard guard(reading_mutex_);
  const auto head = read_head(reading_, tin);
  if (!head.ok()) return head.error();
  return read_answer(reading_, *head, key);
}

Result<void> SqliteStore::put_job(const JobRow& job) {
  return commit([&](Database& database) { return upsert_job(database, job); });
}

Result<void> SqliteStore::remove_job(std::string_view id) {
  return commit(
      [&](Database& database) { return database.query("DELETE FROM job WHERE id = ?").bind_text(id).run(); });
}

Result<std::vector<JobRow>> SqliteStore::list_jobs() {
  const std::lock_guard guard(reading_mutex_);
  return read_jobs(reading_);
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

Result<std::unique_ptr<Store>> open_sqlite_store_for_reading(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(folder / "tinsmith.sqlite3"))
    return tin::base::error(Code::kNotFound, "there is no store in " + folder.string());
  auto store = std::make_unique<SqliteStore>();
  if (auto opened = store->open_for_reading(folder); !opened.ok()) return std::move(opened).error();
  return std::unique_ptr<Store>(std::move(store));
}

}  // namespace server::store
