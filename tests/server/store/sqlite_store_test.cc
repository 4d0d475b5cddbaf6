// What is SQLite's own: damaged files, versions, the lock on the folder, full and failing disks.
#include "server/store/sqlite_store.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "tests/server/store/store_kinds.h"

namespace server::store {
namespace {

using testing::append;
using testing::fails;
using testing::succeeds;
using tin::base::Code;

class SqliteStoreTest : public ::testing::Test {
 protected:
  void SetUp() override {
    reopen();
    ASSERT_TRUE(succeeds(store_->create_tin({"alps", "The Alps", 1}, 1, std::string(5'000'000, 'c'))));
    ASSERT_TRUE(succeeds(append(*store_, "alps", 2, "two", {2, "ada", "note"})));
    ASSERT_TRUE(succeeds(append(*store_, "alps", 3, "three", {3, "bob", "note"})));
  }

  // Checkpoints stand in rows, of which the large one takes two.
  void reopen(SqliteOptions options = {}) {
    store_.reset();
    options.checkpoint_row_bytes = SIZE_MAX;
    auto opened = open_sqlite_store(folder_.path(), options);
    ASSERT_TRUE(succeeds(opened));
    store_ = *std::move(opened);
  }

  // Closes the store and changes its file behind its back.
  void tamper(const std::string& sql) {
    store_.reset();
    sqlite3* raw = nullptr;
    ASSERT_EQ(sqlite3_open((folder_.path() / "tinsmith.sqlite3").c_str(), &raw), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(raw, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(raw);
    sqlite3_close(raw);
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<Store> store_;
};

TEST_F(SqliteStoreTest, DamagedRowsAreReported) {
  const std::pair<const char*, const char*> damages[] = {
      {"UPDATE journal SET record = 'tvo' WHERE revision = 2", "revision 2"},
      {"UPDATE journal SET note = 'nope' WHERE revision = 3", "revision 3"},
      {"UPDATE journal SET revision = 4 WHERE revision = 3", "revision 3"},
      {"DELETE FROM journal WHERE revision = 2", "revision 2"},
      {"UPDATE checkpoint SET bytes = zeroblob(length(bytes)) WHERE chunk = 1", "chunk 1"},
      {"DELETE FROM checkpoint WHERE chunk = 0", "chunk 0"},
      {"DELETE FROM checkpoint WHERE chunk = 1", "length"},
  };
  store_.reset();
  for (const auto& [sql, place] : damages) {
    const testing::TemporaryFolder copy;
    std::filesystem::copy(folder_.path(), copy.path(), std::filesystem::copy_options::recursive);
    tamper(std::string("BEGIN; ") + sql + "; COMMIT");
    reopen();
    const auto loaded = store_->load("alps");
    EXPECT_TRUE(fails(loaded, Code::kStorage)) << sql;
    if (!loaded.ok()) {
      EXPECT_NE(loaded.error().message.find(place), std::string::npos) << loaded.error().message;
    }
    store_.reset();
    std::filesystem::remove_all(folder_.path());
    std::filesystem::copy(copy.path(), folder_.path(), std::filesystem::copy_options::recursive);
  }
  reopen();
  EXPECT_TRUE(succeeds(store_->load("alps")));
}

TEST_F(SqliteStoreTest, DamageToOneTinLeavesTheOthers) {
  ASSERT_TRUE(succeeds(store_->create_tin({"b", "", 0}, 1, "b")));
  tamper("UPDATE journal SET crc = crc + 1");
  reopen();
  EXPECT_TRUE(fails(store_->load("alps"), Code::kStorage));
  EXPECT_TRUE(succeeds(store_->load("b")));
}

TEST_F(SqliteStoreTest, NewerSchemasAreRefused) {
  tamper("PRAGMA user_version = 1000");
  const auto opened = open_sqlite_store(folder_.path());
  ASSERT_TRUE(fails(opened, Code::kUnsupported));
  EXPECT_NE(opened.error().message.find("newer"), std::string::npos) << opened.error().message;
}

TEST_F(SqliteStoreTest, DamagedAndMissingSourcesAreReported) {
  ASSERT_TRUE(succeeds(store_->create_tin({"b", "", 0}, 1, "b", "the source of b")));
  std::filesystem::path file;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path() / "files")) file = entry.path();
  for (const std::string damage : {"the source of c", "short", ""}) {
    if (damage.empty()) {
      std::filesystem::remove(file);
    } else {
      std::ofstream(file, std::ios::trunc) << damage;
    }
    EXPECT_TRUE(fails(store_->load_source("b"), Code::kStorage)) << damage;
    EXPECT_TRUE(succeeds(store_->load("b")));
  }
}

TEST_F(SqliteStoreTest, ASourceThatEndsOnItsWayLeavesNoFile) {
  const auto broken = [](const Sink& sink) -> tin::base::Result<void> {
    if (auto first = sink("some"); !first) return first;
    return tin::base::error(Code::kCancelled, "ended");
  };
  EXPECT_TRUE(fails(store_->create_tin({"b", "", 0}, 1, "b", broken), Code::kCancelled));
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path() / "files"));
}

TEST_F(SqliteStoreTest, LargeCheckpointsAreFilesAndOldOnesGo) {
  store_.reset();
  store_ = *open_sqlite_store(folder_.path(), {.checkpoint_row_bytes = 100});
  const std::filesystem::path files = folder_.path() / "files";
  const auto count = [&] { return std::distance(std::filesystem::directory_iterator(files), {}); };
  const std::string second(1000, '2'), third(1000, '3');
  ASSERT_TRUE(succeeds(store_->create_tin({"b", "", 0}, 1, second)));
  EXPECT_EQ(count(), 1);
  ASSERT_TRUE(succeeds(append(*store_, "b", 2, "two")));
  ASSERT_TRUE(succeeds(store_->put_checkpoint("b", 2, third)));
  EXPECT_EQ(count(), 1);
  EXPECT_EQ(store_->load("b")->checkpoint, third);
  EXPECT_TRUE(fails(store_->put_checkpoint("b", 9, second), Code::kConflict));
  EXPECT_EQ(count(), 1);
  ASSERT_TRUE(succeeds(store_->put_checkpoint("b", 2, "small")));
  EXPECT_EQ(count(), 0);
  EXPECT_EQ(store_->load("b")->checkpoint, "small");
  ASSERT_TRUE(succeeds(store_->put_checkpoint("b", 2, third)));
  for (const auto& entry : std::filesystem::directory_iterator(files)) {
    std::ofstream(entry.path(), std::ios::trunc) << std::string(1000, '4');
  }
  EXPECT_TRUE(fails(store_->load("b"), Code::kStorage));
}

TEST_F(SqliteStoreTest, FilesThatNoRowNamesAreRemovedAtTheStart) {
  ASSERT_TRUE(succeeds(store_->create_tin({"b", "", 0}, 1, "b", "the source of b")));
  const std::filesystem::path files = folder_.path() / "files";
  std::ofstream(files / "orphan.source") << "left by a crash";
  std::ofstream(files / "other.source.part") << "half";
  reopen();
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(files), {}), 1);
  EXPECT_EQ(store_->load_source("b").value(), "the source of b");
  ASSERT_TRUE(succeeds(store_->remove_tin("b")));
  EXPECT_TRUE(std::filesystem::is_empty(files));
}

TEST_F(SqliteStoreTest, AnOlderStoreIsBroughtUpToDate) {
  tamper(
      "DROP TABLE answer; DROP TABLE job; ALTER TABLE tin DROP COLUMN checkpoint_file;"
      "ALTER TABLE tin DROP COLUMN checkpoint_crc; ALTER TABLE tin DROP COLUMN source_file;"
      "ALTER TABLE tin DROP COLUMN source_bytes; ALTER TABLE tin DROP COLUMN source_crc;"
      "PRAGMA user_version = 1");
  reopen();
  EXPECT_EQ(store_->load("alps")->journal.size(), 2U);
  EXPECT_EQ(store_->load_source("alps").value(), "");
  EXPECT_TRUE(succeeds(store_->create_tin({"b", "", 0}, 1, "b", "the source of b")));
}

TEST_F(SqliteStoreTest, OtherDatabasesAreRefused) {
  tamper("PRAGMA user_version = 0");
  EXPECT_TRUE(fails(open_sqlite_store(folder_.path()), Code::kUnsupported));
}

TEST_F(SqliteStoreTest, FilesThatAreNoDatabaseAreRefused) {
  store_.reset();
  const std::filesystem::path file = folder_.path() / "tinsmith.sqlite3";
  std::filesystem::resize_file(file, 0);
  std::filesystem::resize_file(file, 8192);
  EXPECT_TRUE(fails(open_sqlite_store(folder_.path()), Code::kStorage));
}

TEST_F(SqliteStoreTest, AFolderIsOpenedOnce) {
  const auto second = open_sqlite_store(folder_.path());
  ASSERT_TRUE(fails(second, Code::kConflict));
  EXPECT_NE(second.error().message.find((folder_.path() / "lock").string()), std::string::npos);
  store_.reset();
  EXPECT_TRUE(succeeds(open_sqlite_store(folder_.path())));
}

TEST_F(SqliteStoreTest, AnotherProcessIsRefusedToo) {
  const pid_t child = ::fork();
  if (child == 0) {
    const auto opened = open_sqlite_store(folder_.path());
    _exit(!opened.ok() && opened.error().code == Code::kConflict ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

TEST_F(SqliteStoreTest, TheFolderIsMadeButNotItsParents) {
  EXPECT_TRUE(succeeds(open_sqlite_store(folder_.path() / "new")));
  EXPECT_TRUE(fails(open_sqlite_store(folder_.path() / "no" / "parent"), Code::kStorage));
}

TEST_F(SqliteStoreTest, AFullDiskIsNamedAndRecoversWithRoom) {
  ASSERT_TRUE(succeeds(store_->create_tin({"ballast", "", 0}, 1, std::string(1'000'000, 'b'))));
  reopen({.max_file_bytes = 6'300'000});
  std::uint64_t revision = 4;
  auto appended = tin::base::Result<void>();
  for (; revision < 1000; ++revision) {
    appended = append(*store_, "alps", revision, std::string(20'000, 'r'), {});
    if (!appended.ok()) break;
  }
  ASSERT_TRUE(fails(appended, Code::kNoSpace));
  EXPECT_TRUE(appended.error().message.starts_with(kDiskFull)) << appended.error().message;
  EXPECT_EQ(store_->load("alps")->journal.size(),
            revision - 2);  // reading goes on, and nothing was half done
  ASSERT_TRUE(succeeds(store_->remove_tin("ballast")));
  EXPECT_TRUE(succeeds(append(*store_, "alps", revision, std::string(20'000, 'r'), {})));
}

// In a child, whose files may not grow further from some point on: write() fails as a dying disk's would.
int append_on_a_failing_disk(const std::filesystem::path& folder) {
  auto opened = open_sqlite_store(folder);
  if (!opened.ok()) return 2;
  const std::unique_ptr<Store> store = *std::move(opened);
  if (!append(*store, "alps", 4, "four", {}).ok()) return 3;
  ::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{100'000, 100'000};
  if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) return 4;
  std::uint64_t revision = 5;
  while (append(*store, "alps", revision, std::string(10'000, 'x'), {}).ok()) ++revision;
  const auto again = append(*store, "alps", revision, "small", {});
  if (again.ok() || again.error().message.find("restart") == std::string::npos) return 5;
  const auto loaded = store->load("alps");
  return loaded.ok() && loaded->journal.size() == revision - 2 ? 0 : 6;
}

TEST_F(SqliteStoreTest, AfterAFailedWriteNothingIsWrittenAndReadingGoesOn) {
  store_.reset();
  const pid_t child = ::fork();
  if (child == 0) _exit(append_on_a_failing_disk(folder_.path()));
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  reopen();
  EXPECT_TRUE(succeeds(store_->load("alps")));
}

}  // namespace
}  // namespace server::store
