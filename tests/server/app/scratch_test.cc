#include "server/app/scratch.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include "tin/base/array.h"

namespace server::app {
namespace {

namespace fs = std::filesystem;

class ScratchMemoryTest : public testing::Test {
 protected:
  ScratchMemoryTest() {
    std::string pattern = fs::temp_directory_path() / "tinsmith-scratch-XXXXXX";
    folder_ = ::mkdtemp(pattern.data());
  }
  ~ScratchMemoryTest() override { fs::remove_all(folder_); }

  /// Of the process: a line of /proc/self/status, in bytes.
  static std::size_t status(const std::string& wanted) {
    std::ifstream file("/proc/self/status");
    std::string name;
    std::size_t kilobytes = 0;
    while (file >> name) {
      if (name == wanted + ":") {
        file >> kilobytes;
        return kilobytes << 10;
      }
    }
    return 0;
  }

  fs::path folder_;
};

TEST_F(ScratchMemoryTest, HalfOfTheLimitIsInMemoryAndTheRestInFilesWithoutNames) {
  ScratchMemory scratch({1 << 20, folder_});
  tin::base::Array<char> first(400'000, 'a', &scratch);
  EXPECT_EQ(scratch.in_files(), 0U);
  tin::base::Array<char> second(400'000, 'b', &scratch);
  EXPECT_EQ(scratch.in_files(), 400'000U);
  EXPECT_TRUE(fs::is_empty(folder_));
  EXPECT_EQ(first.back(), 'a');
  EXPECT_EQ(second.back(), 'b');
  first = tin::base::Array<char>(&scratch);
  const tin::base::Array<char> third(400'000, 'c', &scratch);
  EXPECT_EQ(scratch.in_files(), 400'000U) << "there was room again";
}

TEST_F(ScratchMemoryTest, WhatIsLetGoOfKeepsItsContents) {
  constexpr std::size_t kCount = 32 << 20, kLimit = 16 << 20, kOvershoot = 48 << 20;
  ScratchMemory scratch({kLimit, folder_});
  const std::size_t anonymous = status("RssAnon"), of_files = status("RssFile");
  tin::base::Array<std::uint32_t> numbers(kCount, &scratch);
  EXPECT_EQ(scratch.in_files(), kCount * sizeof(std::uint32_t));
  std::iota(numbers.begin(), numbers.end(), 7U);
  for (std::size_t i = 0; i < kCount; i += 4099) ASSERT_EQ(numbers[i], i + 7);
  // 128 MiB were written and read; what is resident now is what was touched since the last look.
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_LT(status("RssFile"), of_files + kLimit + kOvershoot);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  EXPECT_LT(status("RssAnon"), anonymous + kLimit);
#endif
  for (std::size_t i = 0; i < kCount; ++i) ASSERT_EQ(numbers[i], static_cast<std::uint32_t>(i + 7));
}

TEST_F(ScratchMemoryTest, ThreadsMayAskAndGiveBackAtOnce) {
  ScratchMemory scratch({1 << 16, folder_});
  std::vector<std::jthread> threads;
  for (unsigned t = 0; t < 4; ++t) {
    threads.emplace_back([&scratch, t] {
      for (std::size_t i = 1; i <= 50; ++i) {
        const tin::base::Array<unsigned> mine(i * 1000, t, &scratch);
        ASSERT_EQ(mine.front() + mine.back(), 2 * t);
      }
    });
  }
  threads.clear();
  EXPECT_EQ(scratch.in_files(), 0U);
}

TEST_F(ScratchMemoryTest, WhereThereIsNoRoomThatIsSaid) {
  ScratchMemory nowhere({1000, folder_ / "nowhere"});
  const auto ask = [](ScratchMemory& scratch, std::size_t bytes) -> std::string {
    try {
      scratch.deallocate(scratch.allocate(bytes), bytes);
    } catch (const NoScratch& none) {
      return none.what();
    }
    return "";
  };
  EXPECT_EQ(ask(nowhere, 500), "");
  const std::string said = ask(nowhere, 5000);
  EXPECT_NE(said.find((folder_ / "nowhere").string()), std::string::npos) << said;
  EXPECT_NE(said.find("No such file"), std::string::npos) << said;
  ScratchMemory here({1000, folder_});
  EXPECT_NE(ask(here, std::size_t{1} << 60), "") << "no disk is as large";
  EXPECT_EQ(ask(here, 5000), "");
  EXPECT_TRUE(fs::is_empty(folder_));
}

}  // namespace
}  // namespace server::app
