#include "server/app/scratch.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <optional>
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
  [[maybe_unused]] const std::size_t anonymous = status("RssAnon");
  const std::size_t of_files = status("RssFile");
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

/// The thread that looks may come late: those who say what they touch do not depend on it.
TEST_F(ScratchMemoryTest, WhatIsResidentIsBoundedForThoseWhoSayWhatTheyTouch) {
  constexpr std::size_t kCount = 64 << 20, kLimit = 32 << 20, kOthers = 2 << 20;
  ScratchMemory scratch({kLimit, folder_});
  tin::base::Array<std::uint32_t> numbers(&scratch);
  const tin::base::Pace pace(&scratch);
  const std::size_t before = status("RssFile");
  numbers.reserve(kCount);
  std::size_t most = 0;
  constexpr std::size_t kAtOnce = tin::base::kPaceBytes / sizeof(std::uint32_t);
  const auto note = [&] {
    most = std::max(most, status("RssFile"));
    pace.touched(1, tin::base::kPaceBytes);
  };
  for (std::size_t i = 0; i < kCount; ++i) {
    numbers.push_back(static_cast<std::uint32_t>(i));
    if (i % kAtOnce == 0) note();
  }
  std::size_t sum = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    sum += numbers[i] == i ? 1 : 0;
    if (i % kAtOnce == 0) note();
  }
  EXPECT_EQ(sum, kCount);
  EXPECT_LE(most, before + kLimit / 2 + kLimit / 16 + 2 * tin::base::kPaceBytes + kOthers);
  EXPECT_GT(most, before + kLimit / 4) << "and no less is used than may be";
}

TEST_F(ScratchMemoryTest, SeveralHaveTheSumOfTheirHalves) {
  constexpr std::size_t kBytes = 40 << 20, kLimit = 32 << 20, kOthers = 2 << 20;
  ScratchMemory one({kLimit, folder_}), other({kLimit, folder_});
  const std::size_t before = status("RssFile");
  const auto first = tin::base::filled<char>(kBytes, 'a', &one),
             second = tin::base::filled<char>(kBytes, 'b', &other);
  EXPECT_LE(status("RssFile"), before + kLimit + kLimit / 8 + 2 * tin::base::kPaceBytes + kOthers);
  EXPECT_EQ(std::count(first.begin(), first.end(), 'a'), kBytes);
  EXPECT_EQ(std::count(second.begin(), second.end(), 'b'), kBytes);
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

TEST_F(ScratchMemoryTest, AQuotaOfFilesIsForAllAndHoldsToTheByte) {
  const auto quota = std::make_shared<ScratchQuota>(300'000);
  ScratchMemory one({1000, folder_, quota}), other({1000, folder_, quota});
  const auto refused = [](ScratchMemory& scratch, std::size_t bytes) -> std::optional<tin::base::Code> {
    try {
      scratch.deallocate(scratch.allocate(bytes), bytes);
    } catch (const NoScratch& none) {
      return none.error().code;
    }
    return std::nullopt;
  };
  EXPECT_EQ(refused(one, 300'000), std::nullopt);
  EXPECT_EQ(refused(one, 300'001), tin::base::Code::kTooLarge);
  {
    const tin::base::Array<char> some(100'000, 'a', &one);
    EXPECT_EQ(quota->taken(), 100'000U);
    EXPECT_EQ(refused(one, 200'000), std::nullopt);
    EXPECT_EQ(refused(one, 200'001), tin::base::Code::kTooLarge) << "it has some already";
    EXPECT_EQ(refused(other, 200'000), std::nullopt);
    EXPECT_EQ(refused(other, 200'001), tin::base::Code::kTooMany);
  }
  EXPECT_EQ(quota->taken(), 0U);
  ScratchMemory nowhere({1000, folder_ / "nowhere", quota});
  EXPECT_EQ(refused(nowhere, 5000), tin::base::Code::kStorage);
  EXPECT_EQ(quota->taken(), 0U);
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
