// A store in memory that can be told to fail.
#pragma once

#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <thread>

#include "server/store/store.h"

namespace tests::app {

/// Keeps the journal and the answers of one TIN, and forgets checkpoints. Thread-safe.
class FailingStore : public server::store::Store {
 public:
  template <class T>
  using Result = tin::base::Result<T>;
  using Entry = server::store::Entry;
  using Answer = server::store::Answer;
  using JournalRow = server::store::JournalRow;

  bool fail = false;
  std::string source;                  // of the TIN
  std::chrono::milliseconds delay{0};  // of a commit
  std::size_t appended = 0;            // revisions
  std::atomic<std::size_t> commits{0};

  Result<void> create_tin(const server::store::TinRecord&, std::uint64_t, std::string_view,
                          const server::store::Pieces&) override {
    return status();
  }
  Result<void> update_title(std::string_view, std::string_view) override { return status(); }
  Result<void> remove_tin(std::string_view) override { return status(); }
  Result<void> append(std::string_view, std::span<const Entry> entries) override {
    std::this_thread::sleep_for(delay);
    const std::lock_guard guard(mutex_);
    if (fail) return status();
    ++commits;
    for (const Entry& entry : entries) {
      if (entry.row) rows_.push_back(*entry.row);
      if (entry.answer) answers_[entry.answer->key] = *entry.answer;
    }
    appended = rows_.size();
    return {};
  }
  Result<void> put_checkpoint(std::string_view, std::uint64_t, std::string_view) override { return status(); }
  Result<void> trim_journal(std::string_view, const server::store::Retention&) override { return status(); }
  Result<void> trim_answers(std::int64_t, std::uint64_t) override { return status(); }
  Result<std::vector<server::store::TinRecord>> list() override {
    return std::vector<server::store::TinRecord>{};
  }
  Result<server::store::Loaded> load(std::string_view) override {
    return tin::base::error(tin::base::Code::kNotFound, "");
  }
  Result<void> read_source(std::string_view, const server::store::MeasuredSink& sink) override {
    return source.empty() ? Result<void>() : sink(source, source.size());
  }
  Result<std::vector<JournalRow>> read_journal(std::string_view,
                                               const server::store::JournalRange& range) override {
    const std::lock_guard guard(mutex_);
    std::vector<JournalRow> rows;
    for (const JournalRow& row : rows_) {
      if (row.revision >= range.first && row.revision <= range.last) rows.push_back(row);
    }
    return rows;
  }
  Result<server::store::JournalExtent> journal_extent(std::string_view) override {
    return server::store::JournalExtent{};
  }
  Result<std::optional<Answer>> find_answer(std::string_view, std::string_view key) override {
    const std::lock_guard guard(mutex_);
    const auto found = answers_.find(std::string(key));
    return found == answers_.end() ? std::optional<Answer>() : std::optional<Answer>(found->second);
  }
  Result<void> put_job(const server::store::JobRow&) override { return status(); }
  Result<void> remove_job(std::string_view) override { return status(); }
  Result<std::vector<server::store::JobRow>> list_jobs() override {
    return std::vector<server::store::JobRow>{};
  }
  Result<void> writable() const override { return status(); }
  Counts counts() const override { return {}; }

 private:
  Result<void> status() const {
    if (fail) return tin::base::error(tin::base::Code::kStorage, "the disk failed");
    return {};
  }

  std::mutex mutex_;
  std::vector<JournalRow> rows_;
  std::map<std::string, Answer> answers_;
};

}  // namespace tests::app
