#include "server/config.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

namespace server {
namespace {

using nlohmann::json;
using tin::base::Code;

Config parsed(std::string_view text) {
  auto config = parse_config(text, "test.json");
  EXPECT_TRUE(config.ok()) << config.error().message;
  return config.ok() ? *config : Config{};
}

// Expects an error with this code at this pointer, with both file and pointer in its sentence.
void expect_error(std::string_view text, Code code, const std::string& where) {
  const auto config = parse_config(text, "test.json");
  ASSERT_FALSE(config.ok()) << text;
  EXPECT_EQ(config.error().code, code) << config.error().message;
  EXPECT_EQ(config.error().where, where) << config.error().message;
  EXPECT_TRUE(config.error().message.starts_with("test.json: " + where)) << config.error().message;
}

json example() {
  return json::parse(std::ifstream(TINSMITH_EXAMPLE_CONFIG));
}

TEST(ConfigTest, NothingSetMeansDefaults) {
  EXPECT_EQ(parsed("{}"), Config{});
}

TEST(ConfigTest, TheExampleIsExactlyTheDefaults) {
  const auto config = read_config(TINSMITH_EXAMPLE_CONFIG);
  ASSERT_TRUE(config.ok()) << config.error().message;
  EXPECT_EQ(*config, Config{});
}

// Changing any number of the example changes the configuration: no key is accepted and then ignored.
TEST(ConfigTest, EveryNumberOfTheExampleCounts) {
  int numbers = 0;
  const json document = example();
  const json flat = document.flatten();
  for (const auto& [pointer, value] : flat.items()) {
    if (!value.is_number()) continue;
    json changed = document;
    changed[json::json_pointer(pointer)] = value.get<std::int64_t>() + 1;
    EXPECT_NE(parsed(changed.dump()), Config{}) << pointer;
    ++numbers;
  }
  EXPECT_EQ(numbers, 34);
}

TEST(ConfigTest, APublicUrlIsOneOfTheWeb) {
  EXPECT_EQ(parsed(R"({"public_url":"https://terrain.example.org/a"})").public_url, "https://terrain.example.org/a");
  EXPECT_EQ(parsed(R"({"public_url":""})").public_url, "");
  for (const char* wrong : {"7", "\"ftp://a\"", "\"http://a/\"", "\"http://a b\"", "\"http://a?x\"", "\"a.example.org\""}) {
    expect_error(std::string(R"({"public_url":)") + wrong + "}", Code::kInvalidValue, "/public_url");
  }
}

TEST(ConfigTest, TheExampleHasEveryKey) {
  constexpr std::size_t kNumbers =
      (sizeof(LimitConfig) + sizeof(JobConfig) + sizeof(HistoryConfig) + sizeof(HttpConfig)) / sizeof(std::int64_t);
  EXPECT_EQ(example().flatten().size(), kNumbers + 3);  // and listen, data_dir, log_level
}

TEST(ConfigTest, ValuesAreTaken) {
  const Config config = parsed(R"({"listen": "[::1]:0", "data_dir": "/srv/tins", "log_level": "debug",
                                   "limits": {"tins": 7}, "jobs": {"workers": 2},
                                   "http": {"drain_seconds": 0}})");
  EXPECT_EQ(config.listen, (Listen{"::1", 0}));
  EXPECT_EQ(config.data_dir, "/srv/tins");
  EXPECT_EQ(config.log_level, "debug");
  EXPECT_EQ(config.limits.tins, 7);
  EXPECT_EQ(config.jobs.workers, 2);
  EXPECT_EQ(config.http.drain_seconds, 0);
}

TEST(ConfigTest, RangesEndWhereTheyEnd) {
  EXPECT_EQ(parsed(R"({"limits": {"tins": 1}})").limits.tins, 1);
  EXPECT_EQ(parsed(R"({"limits": {"tins": 1000000}})").limits.tins, 1000000);
  for (const char* value : {"0", "1000001", "-1", "18446744073709551615", "9223372036854775808", "1e300"}) {
    expect_error(std::string(R"({"limits": {"tins": )") + value + "}}", Code::kInvalidValue, "/limits/tins");
  }
}

TEST(ConfigTest, WrongTypesAreNamed) {
  for (const char* value : {"\"7\"", "7.0", "null", "true", "[]", "{}"}) {
    expect_error(std::string(R"({"http": {"io_threads": )") + value + "}}", Code::kInvalidValue,
                 "/http/io_threads");
  }
  expect_error(R"({"limits": 3})", Code::kInvalidValue, "/limits");
  expect_error(R"({"listen": 8080})", Code::kInvalidValue, "/listen");
  expect_error(R"({"data_dir": ""})", Code::kInvalidValue, "/data_dir");
  expect_error(R"({"log_level": "INFO"})", Code::kInvalidValue, "/log_level");
}

TEST(ConfigTest, UnknownKeysAreNamed) {
  expect_error(R"({"port": 80})", Code::kUnknownParameter, "/port");
  expect_error(R"({"limits": {"tin": 3}})", Code::kUnknownParameter, "/limits/tin");
  expect_error(R"({"limits": {"a/b~": 3}})", Code::kUnknownParameter, "/limits/a~1b~0");
  expect_error(R"({"jobs": {"tins": 3}})", Code::kUnknownParameter, "/jobs/tins");
}

TEST(ConfigTest, APageIsNotLargerThanTheLargest) {
  EXPECT_EQ(parsed(R"({"limits": {"page_size": 50, "page_size_max": 50}})").limits.page_size_max, 50);
  expect_error(R"({"limits": {"page_size": 51, "page_size_max": 50}})", Code::kInvalidValue,
               "/limits/page_size");
}

TEST(ConfigTest, WhatIsNoJsonObjectIsMalformed) {
  for (const char* text : {"", "[]", "7", "{", "{} {}", "{'a': 1}"}) expect_error(text, Code::kMalformed, "");
}

TEST(ConfigTest, AMissingFileIsNamed) {
  const auto config = read_config("/nowhere/config.json");
  ASSERT_FALSE(config.ok());
  EXPECT_EQ(config.error().code, Code::kNotFound);
  EXPECT_NE(config.error().message.find("/nowhere/config.json"), std::string::npos);
}

TEST(ListenTest, AddressesAndPorts) {
  const std::pair<const char*, Listen> cases[] = {
      {"127.0.0.1:8080", {"127.0.0.1", 8080}}, {"0.0.0.0:0", {"0.0.0.0", 0}},
      {"[::1]:8080", {"::1", 8080}},           {"[::]:65535", {"::", 65535}},
      {"localhost:1", {"127.0.0.1", 1}},
  };
  for (const auto& [text, expected] : cases) {
    const auto listen = parse_listen(text);
    ASSERT_TRUE(listen.ok()) << text;
    EXPECT_EQ(*listen, expected) << text;
  }
}

TEST(ListenTest, AllElseIsRefused) {
  for (const std::string text : {"",
                                 ":",
                                 "8080",
                                 ":8080",
                                 "127.0.0.1",
                                 "127.0.0.1:",
                                 "127.0.0.1:65536",
                                 "127.0.0.1:-1",
                                 "127.0.0.1:+1",
                                 "127.0.0.1: 80",
                                 "127.0.0.1:80x",
                                 "256.0.0.1:80",
                                 "::1:8080",
                                 "[::1]",
                                 "[::1]:",
                                 "[]:80",
                                 "[127.0.0.1]:80",
                                 "[::1:80",
                                 "example.org:80",
                                 "127.1:80"}) {
    const auto listen = parse_listen(text);
    ASSERT_FALSE(listen.ok()) << text;
    EXPECT_EQ(listen.error().code, Code::kInvalidValue);
  }
  EXPECT_FALSE(parse_listen(std::string_view("127.0.0.1\0:80", 13)).ok());
}

}  // namespace
}  // namespace server
