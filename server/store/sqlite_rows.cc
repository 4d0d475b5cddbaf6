#include "server/store/sqlite_rows.h"

#include <algorithm>

#include "server/store/row_checksum.h"

namespace server::store {
namespace {

using tin::base::Code;
using tin::base::Result;

// Rows stay far below SQLite's limit of 10^9 bytes, and memory for one is small.
constexpr std::size_t kChunkBytes = std::size_t{4} << 20;

Result<void> write_chunks(Database& database, std::int64_t key, std::uint64_t revision,
                          std::string_view bytes) {
  for (std::int64_t chunk = 0; !bytes.empty(); ++chunk) {
    const std::string_view piece = bytes.substr(0, kChunkBytes);
    Query insert =
        database.query("INSERT INTO checkpoint(tin, revision, chunk, bytes, crc) VALUES(?, ?, ?, ?, ?)");
    insert.bind(key).bind(revision).bind(chunk).bind_blob(piece).bind(
        std::int64_t{checksum(revision, chunk, piece)});
    if (auto done = insert.run(); !done.ok()) return done;
    bytes.remove_prefix(piece.size());
  }
  return {};
}

std::uint64_t size_of(const NewCheckpoint& checkpoint) {
  return checkpoint.file.name.empty() ? checkpoint.bytes.size() : checkpoint.file.bytes;
}

Result<void> insert_row(Database& database, const Head& head, const JournalRow& row) {
  Query insert = database.query(
      "INSERT INTO journal(tin, revision, record, time_ms, author, note, crc) VALUES(?, ?, ?, ?, ?, ?, ?)");
  insert.bind(head.key).bind(row.revision).bind_blob(row.record).bind(row.info.time_ms);
  return insert.bind_text(row.info.author).bind_text(row.info.note).bind(std::int64_t{checksum(row)}).run();
}

Result<void> insert_answer(Database& database, const Head& head, const Answer& answer) {
  const auto present = read_answer(database, head, answer.key);
  if (!present.ok()) return present.error();
  if (*present) return tin::base::error(Code::kConflict, "the idempotency key was used already");
  Query insert =
      database.query("INSERT INTO answer(tin, key, request, bytes, time_ms, crc) VALUES(?, ?, ?, ?, ?, ?)");
  insert.bind(head.key).bind_text(answer.key).bind_blob(answer.request).bind_blob(answer.bytes);
  return insert.bind(answer.time_ms).bind(std::int64_t{checksum(answer)}).run();
}

Result<std::uint64_t> natural_of(Query& query) {
  const auto row = query.next();
  if (!row.ok()) return row.error();
  return *row ? query.natural(0) : 0;
}

}  // namespace

tin::base::Error no_such_tin(std::string_view id) {
  return tin::base::error(Code::kNotFound, "no TIN \"" + std::string(id) + "\"");
}

tin::base::Error damaged(std::string_view tin, const std::string& what) {
  return tin::base::error(Code::kStorage, "the store is damaged: TIN \"" + std::string(tin) + "\", " + what);
}

Result<Head> read_head(Database& database, std::string_view tin) {
  Query query = database.query(
      "SELECT key, id, title, created_ms, checkpoint_revision, checkpoint_bytes, max(checkpoint_revision,"
      " coalesce((SELECT max(revision) FROM journal WHERE journal.tin = tin.key), 0)), checkpoint_file,"
      " checkpoint_crc, source_file, source_bytes, source_crc FROM tin WHERE id = ?");
  const auto row = query.bind_text(tin).next();
  if (!row.ok()) return row.error();
  if (!*row) return no_such_tin(tin);
  const auto crc = [&](int column) { return static_cast<std::uint32_t>(query.integer(column)); };
  return Head{query.integer(0),
              {query.bytes(1), query.bytes(2), query.integer(3)},
              query.natural(4),
              query.natural(5),
              query.natural(6),
              {query.bytes(7), query.natural(5), crc(8)},
              {query.bytes(9), query.natural(10), crc(11)}};
}

Result<std::vector<TinRecord>> read_tins(Database& database) {
  Query query = database.query("SELECT id, title, created_ms FROM tin ORDER BY id");
  std::vector<TinRecord> tins;
  for (;;) {
    const auto row = query.next();
    if (!row.ok()) return row.error();
    if (!*row) return tins;
    tins.push_back({query.bytes(0), query.bytes(1), query.integer(2)});
  }
}

Result<std::vector<std::string>> read_file_names(Database& database) {
  Query query = database.query("SELECT source_file, checkpoint_file FROM tin");
  std::vector<std::string> names;
  for (;;) {
    const auto row = query.next();
    if (!row.ok()) return row.error();
    if (!*row) break;
    for (const int column : {0, 1}) {
      if (std::string name = query.bytes(column); !name.empty()) names.push_back(std::move(name));
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

Result<void> insert_tin(Database& database, const TinRecord& tin, std::uint64_t revision,
                        const NewCheckpoint& checkpoint, const FileReference& source) {
  auto present = read_head(database, tin.id);
  if (present.ok()) return tin::base::error(Code::kConflict, "there is a TIN \"" + tin.id + "\" already");
  if (present.error().code != Code::kNotFound) return present.error();
  Query insert = database.query(
      "INSERT INTO tin(id, title, created_ms, checkpoint_revision, checkpoint_bytes, checkpoint_file,"
      " checkpoint_crc, source_file, source_bytes, source_crc) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  insert.bind_text(tin.id).bind_text(tin.title).bind(tin.created_ms).bind(revision).bind(size_of(checkpoint));
  insert.bind_text(checkpoint.file.name).bind(std::int64_t{checkpoint.file.crc});
  insert.bind_text(source.name).bind(source.bytes).bind(std::int64_t{source.crc});
  if (auto done = insert.run(); !done.ok()) return done;
  const auto key = database.number("SELECT last_insert_rowid()");
  if (!key.ok()) return key.error();
  return write_chunks(database, *key, revision, checkpoint.bytes);
}

Result<void> replace_checkpoint(Database& database, const Head& head, std::uint64_t revision,
                                const NewCheckpoint& checkpoint) {
  if (revision < head.checkpoint_revision || revision > head.last_revision) {
    return tin::base::error(Code::kConflict, "no checkpoint of revision " + std::to_string(revision) +
                                                 ": it must be one from " +
                                                 std::to_string(head.checkpoint_revision) + " to " +
                                                 std::to_string(head.last_revision));
  }
  if (auto done = database.query("DELETE FROM checkpoint WHERE tin = ?").bind(head.key).run(); !done.ok())
    return done;
  Query update = database.query(
      "UPDATE tin SET checkpoint_revision = ?, checkpoint_bytes = ?, checkpoint_file = ?, checkpoint_crc = ?"
      " WHERE key = ?");
  update.bind(revision).bind(size_of(checkpoint)).bind_text(checkpoint.file.name);
  update.bind(std::int64_t{checkpoint.file.crc}).bind(head.key);
  if (auto done = update.run(); !done.ok()) return done;
  return write_chunks(database, head.key, revision, checkpoint.bytes);
}

Result<std::string> read_checkpoint_rows(Database& database, const Head& head) {
  Query query = database.query(
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

Result<void> insert_entry(Database& database, Head& head, const Entry& entry) {
  if (entry.row) {
    if (entry.row->revision != head.last_revision + 1) {
      return tin::base::error(Code::kConflict, "revision " + std::to_string(entry.row->revision) +
                                                   " does not follow revision " +
                                                   std::to_string(head.last_revision));
    }
    if (auto done = insert_row(database, head, *entry.row); !done.ok()) return done;
    head.last_revision = entry.row->revision;
  }
  return entry.answer ? insert_answer(database, head, *entry.answer) : Result<void>();
}

Result<std::vector<JournalRow>> read_rows(Database& database, const Head& head, const JournalRange& range) {
  constexpr const char* kAscending =
      "SELECT revision, record, time_ms, author, note, crc FROM journal WHERE tin = ? AND revision >= ? AND"
      " revision <= ? ORDER BY revision";
  constexpr const char* kDescending =
      "SELECT revision, record, time_ms, author, note, crc FROM journal WHERE tin = ? AND revision >= ? AND"
      " revision <= ? ORDER BY revision DESC";
  const std::uint64_t first = range.first, last = std::min<std::uint64_t>(range.last, INT64_MAX);
  std::vector<JournalRow> rows;
  if (first > last) return rows;
  Query query = database.query(range.newest_first ? kDescending : kAscending);
  query.bind(head.key).bind(first).bind(last);
  std::size_t bytes = 0;
  while (rows.size() < range.most_rows && (rows.empty() || bytes < range.most_bytes)) {
    const auto more = query.next();
    if (!more.ok()) return more.error();
    if (!*more) break;
    JournalRow row{query.natural(0), query.bytes(1), {query.integer(2), query.bytes(3), query.bytes(4)}};
    const std::uint64_t expected =
        rows.empty() ? row.revision
                     : (range.newest_first ? rows.back().revision - 1 : rows.back().revision + 1);
    if (row.revision != expected || query.integer(5) != checksum(row))
      return damaged(head.tin.id, "revision " + std::to_string(expected) + " of its journal");
    bytes += row.record.size();
    rows.push_back(std::move(row));
  }
  return rows;
}

Result<JournalExtent> read_extent(Database& database, const Head& head) {
  Query query = database.query("SELECT coalesce(min(revision), 0) FROM journal WHERE tin = ?");
  const auto first = natural_of(query.bind(head.key));
  if (!first.ok()) return first.error();
  return JournalExtent{*first, head.last_revision, head.checkpoint_revision};
}

Result<void> trim_rows(Database& database, const Head& head, const Retention& kept) {
  std::uint64_t forget = 0;  // up to this revision
  if (kept.revisions < head.last_revision) forget = head.last_revision - kept.revisions;
  if (kept.bytes < INT64_MAX) {
    Query query = database.query(
        "SELECT coalesce(max(revision), 0) FROM (SELECT revision, sum(length(record)) OVER (ORDER BY revision"
        " DESC) AS bytes FROM journal WHERE tin = ?) WHERE bytes > ?");
    const auto past = natural_of(query.bind(head.key).bind(kept.bytes));
    if (!past.ok()) return past.error();
    forget = std::max(forget, *past);
  }
  Query query = database.query("DELETE FROM journal WHERE tin = ? AND revision <= ?");
  return query.bind(head.key).bind(std::min(forget, head.checkpoint_revision)).run();
}

Result<std::optional<Answer>> read_answer(Database& database, const Head& head, std::string_view key) {
  Query query =
      database.query("SELECT key, request, bytes, time_ms, crc FROM answer WHERE tin = ? AND key = ?");
  const auto row = query.bind(head.key).bind_text(key).next();
  if (!row.ok()) return row.error();
  if (!*row) return std::optional<Answer>();
  Answer answer{query.bytes(0), query.bytes(1), query.bytes(2), query.integer(3)};
  if (query.integer(4) != checksum(answer))
    return damaged(head.tin.id, "the answer under an idempotency key");
  return std::optional<Answer>(std::move(answer));
}

Result<void> trim_answer_rows(Database& database, std::int64_t before_ms, std::uint64_t most) {
  Query old = database.query("DELETE FROM answer WHERE time_ms < ?");
  if (auto done = old.bind(before_ms).run(); !done.ok()) return done;
  const auto present = database.number("SELECT count(*) FROM answer");
  if (!present.ok()) return present.error();
  if (static_cast<std::uint64_t>(*present) <= most) return {};
  Query many = database.query(
      "DELETE FROM answer WHERE (tin, key) IN (SELECT tin, key FROM answer ORDER BY time_ms LIMIT ?)");
  return many.bind(static_cast<std::uint64_t>(*present) - most).run();
}

Result<void> upsert_job(Database& database, const JobRow& job) {
  Query query = database.query(
      "INSERT INTO job(id, kind, description, state, created_ms, started_ms, finished_ms, message, error,"
      " error_where, result) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT(id) DO UPDATE SET"
      " state = excluded.state, started_ms = excluded.started_ms, finished_ms = excluded.finished_ms,"
      " message = excluded.message, error = excluded.error, error_where = excluded.error_where,"
      " result = excluded.result");
  query.bind_text(job.id).bind_text(job.kind).bind_text(job.description).bind(job.state).bind(job.created_ms);
  query.bind(job.started_ms).bind(job.finished_ms).bind_text(job.message).bind_text(job.error);
  return query.bind_text(job.where).bind_text(job.result).run();
}

Result<std::vector<JobRow>> read_jobs(Database& database) {
  Query query = database.query(
      "SELECT id, kind, description, state, created_ms, started_ms, finished_ms, message, error, error_where,"
      " result FROM job ORDER BY number");
  std::vector<JobRow> jobs;
  for (;;) {
    const auto row = query.next();
    if (!row.ok()) return row.error();
    if (!*row) return jobs;
    jobs.push_back({query.bytes(0), query.bytes(1), query.bytes(2), query.integer(3), query.integer(4),
                    query.integer(5), query.integer(6), query.bytes(7), query.bytes(8), query.bytes(9),
                    query.bytes(10)});
  }
}

}  // namespace server::store
