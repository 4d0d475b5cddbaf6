#include "server/obs/log.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <thread>
#include <vector>

namespace server::obs {
namespace {

using nlohmann::json;

TEST(LogTest, FieldsKeepTheirTypes) {
  EXPECT_EQ(
      log_members("e", {{"s", "text"}, {"i", -3}, {"u", 18446744073709551615ULL}, {"d", 1.25}, {"b", true}}),
      R"("event":"e","s":"text","i":-3,"u":18446744073709551615,"d":1.25,"b":true)");
}

TEST(LogTest, AwkwardTextIsEscaped) {
  const std::string line = log_members(
      "a\"b\\c\nd\x7f", {{"bad", std::string("x\xff\xc0\xaf\xed\xa0\x80y\xc3\xa4\xf0\x9f\x8f\x94")}});
  EXPECT_EQ(line.find('\n'), std::string::npos);
  const json parsed = json::parse("{" + line + "}");
  EXPECT_EQ(parsed["event"], "a\"b\\c\nd\x7f");
  EXPECT_EQ(parsed["bad"], "x\ufffd\ufffd\ufffd\ufffd\ufffd\ufffdy\u00e4\U0001f3d4");
}

TEST(LogTest, NumbersThatJsonLacksAreNull) {
  EXPECT_EQ(log_members("e", {{"a", std::nan("")}, {"b", std::numeric_limits<double>::infinity()}}),
            R"("event":"e","a":null,"b":null)");
}

TEST(LogTest, AnyBytesGiveOneLineOfJson) {
  std::mt19937 random{std::random_device{}()};
  for (int round = 0; round < 5000; ++round) {
    std::string text(random() % 12, '\0');
    for (char& c : text) c = static_cast<char>(random());
    const std::string line = log_members(text, {{text, text}});
    ASSERT_TRUE(json::accept("{" + line + "}"));
    ASSERT_EQ(line.find('\n'), std::string::npos);
  }
}

TEST(LogTest, LinesHaveTimeLevelAndEvent) {
  ::testing::internal::CaptureStderr();
  log_info("started", {{"port", 8080}});
  log_error("broke {} %v", {{"why", "100 %"}});
  std::istringstream lines(::testing::internal::GetCapturedStderr());
  std::string line;
  ASSERT_TRUE(std::getline(lines, line));
  const json first = json::parse(line);
  EXPECT_EQ(first["level"], "info");
  EXPECT_EQ(first["event"], "started");
  EXPECT_EQ(first["port"], 8080);
  EXPECT_EQ(first["time"].get<std::string>().size(), std::string("2024-05-01T12:00:00.000Z").size());
  ASSERT_TRUE(std::getline(lines, line));
  EXPECT_EQ(json::parse(line)["event"], "broke {} %v");
  EXPECT_EQ(json::parse(line)["level"], "error");
}

TEST(LogTest, LevelsBelowTheChosenOneAreSilent) {
  ::testing::internal::CaptureStderr();
  log_debug("no");
  set_log_level(LogLevel::kError);
  log_warning("no");
  set_log_level(LogLevel::kOff);
  log_error("no");
  set_log_level(LogLevel::kDebug);
  log_debug("yes");
  set_log_level(LogLevel::kInfo);
  const std::string written = ::testing::internal::GetCapturedStderr();
  EXPECT_EQ(written.find("\"no\""), std::string::npos);
  EXPECT_NE(written.find("\"yes\""), std::string::npos);
}

TEST(LogTest, LevelsHaveNames) {
  EXPECT_EQ(log_level_named("debug"), LogLevel::kDebug);
  EXPECT_EQ(log_level_named("warning"), LogLevel::kWarning);
  EXPECT_EQ(log_level_named("off"), LogLevel::kOff);
  EXPECT_FALSE(log_level_named("INFO"));
}

TEST(LogTest, LinesOfManyThreadsDoNotMix) {
  ::testing::internal::CaptureStderr();
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([t] {
      for (int i = 0; i < 100; ++i) log_info("line", {{"thread", t}, {"i", i}});
    });
  }
  for (std::thread& thread : threads) thread.join();
  std::istringstream lines(::testing::internal::GetCapturedStderr());
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) ASSERT_TRUE(json::accept(line)) << line;
  EXPECT_EQ(count, 400);
}

}  // namespace
}  // namespace server::obs
