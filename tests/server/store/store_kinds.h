// The implementations that the suites of the interface run on: a new one is added to store_kinds().
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/store/sqlite_store.h"
#include "server/store/store.h"

namespace server::store::testing {

/// A folder of its own, gone afterwards.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "tinsmith-store-XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// One implementation: opens the store that lives in a folder.
struct StoreKind {
  std::string name;
  std::function<tin::base::Result<std::unique_ptr<Store>>(const std::filesystem::path&)> open;
};

inline std::vector<StoreKind> store_kinds() {
  return {{"Sqlite", [](const std::filesystem::path& folder) { return open_sqlite_store(folder); }}};
}

/// Adds one revision.
inline tin::base::Result<void> append(Store& store, std::string_view tin, std::uint64_t revision,
                                      std::string_view record, const RevisionInfo& info = {}) {
  const Entry entry{JournalRow{revision, std::string(record), info}, std::nullopt};
  return store.append(tin, {&entry, 1});
}

/// A fixture with a store in a folder.
class AnyStore : public ::testing::TestWithParam<StoreKind> {
 protected:
  void SetUp() override { open(); }

  void open() {
    auto opened = GetParam().open(folder_.path());
    ASSERT_TRUE(opened.ok()) << opened.error().message;
    store_ = *std::move(opened);
  }
  void close() { store_.reset(); }
  void reopen() {
    close();
    open();
  }

  TemporaryFolder folder_;
  std::unique_ptr<Store> store_;
};

inline std::string name_of(const ::testing::TestParamInfo<StoreKind>& info) {
  return info.param.name;
}

/// Fails the test unless `result` is a success.
template <class Value>
::testing::AssertionResult succeeds(const tin::base::Result<Value>& result) {
  if (result.ok()) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << result.error().message;
}

/// Fails the test unless `result` is an error with this code.
template <class Value>
::testing::AssertionResult fails(const tin::base::Result<Value>& result, tin::base::Code code) {
  if (result.ok()) return ::testing::AssertionFailure() << "no error";
  if (result.error().code == code && !result.error().message.empty()) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure()
         << "code " << static_cast<int>(result.error().code) << ": " << result.error().message;
}

}  // namespace server::store::testing
