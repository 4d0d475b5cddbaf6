#include "proto/json_read.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/point_sets.h"

namespace {

using proto::Document;
using tin::base::Code;
using tin::base::Error;

Error parse_error(std::string_view text) {
  auto document = Document::parse(text);
  EXPECT_FALSE(document.ok()) << text;
  return document.ok() ? Error{} : document.error();
}

proto::Value member(const Document& document, std::string_view name) {
  return document.root().any_object()->require(name).value();
}

TEST(JsonReadTest, ReadsWhatIsThere) {
  const Document document =
      Document::parse(R"({"s":"h\u00e9","n":-1.5e2,"i":7,"t":true,"a":[1,[2],{"b":3}],"e":{}})").value();
  EXPECT_EQ(member(document, "s").string(10).value(), "h\xc3\xa9");
  EXPECT_EQ(member(document, "n").number().value(), -150);
  EXPECT_EQ(member(document, "i").integer(0, 10).value(), 7);
  EXPECT_TRUE(member(document, "t").boolean().value());
  EXPECT_EQ(member(document, "a").array(3)->size(), 3U);
  std::vector<std::string> places;
  const proto::Array array = member(document, "a").array(3).value();
  for (const proto::Value value : array) places.push_back(value.pointer());
  EXPECT_EQ(places, (std::vector<std::string>{"/a/0", "/a/1", "/a/2"}));
  EXPECT_FALSE(member(document, "e").any_object()->find("x").has_value());
  EXPECT_EQ(document.root().pointer(), "");
}

TEST(JsonReadTest, SyntaxErrorsNameTheByte) {
  EXPECT_EQ(parse_error(R"({"a":1} x)").message, "not valid JSON at byte 8");
  EXPECT_EQ(parse_error("[1,]").message, "not valid JSON at byte 3");
  EXPECT_EQ(parse_error("[1,2").message, "not valid JSON: the text ends too early, at byte 4");
  EXPECT_EQ(parse_error("").message, "not valid JSON: the text ends too early, at byte 0");
}

TEST(JsonReadTest, RefusesWhatIsNotJson) {
  using namespace std::string_literals;
  for (const std::string& text :
       {"NaN"s,          "[Infinity]"s,       "[-Infinity]"s, "[01]"s,   "[+1]"s,     "[.5]"s,
        "[1.]"s,         "{'a':1}"s,          "{\"a\":1,}"s,  "[1]//"s,  "/**/[1]"s,  "\"\xff\""s,
        "\"\xc3\x28\""s, "\"\xed\xa0\x80\""s, "\"\\ud800\""s, "\"\t\""s, "[1]\0[2]"s, "[1]\0"s,
        "\0"s,           "\"a\0b\""s,         "{\"a\"}"s,     "nul"s,    "[1]]"s,     "\"\\x\""s}) {
    EXPECT_EQ(parse_error(text).code, Code::kMalformed) << text;
  }
}

TEST(JsonReadTest, NumbersThatNoDoubleHoldsAreNotFiniteAndSayWhere) {
  const Error first = parse_error(R"({"ops":[{"x":1},{"x":1e999}]})");
  EXPECT_EQ(first.code, Code::kNotFinite);
  EXPECT_EQ(first.where, "/ops/1/x");
  EXPECT_EQ(parse_error("-1e999").code, Code::kNotFinite);
  EXPECT_EQ(Document::parse("[1e-999]")->root().array(1)->size(), 1U);
}

TEST(JsonReadTest, NamesThatComeTwiceAreErrors) {
  const Error error = parse_error(R"([{"a":1},{"b":{"c":1,"d":2,"c":3}}])");
  EXPECT_EQ(error.code, Code::kMalformed);
  EXPECT_EQ(error.where, "/1/b/c");
  EXPECT_EQ(parse_error(R"({"a":1,"\u0061":2})").where, "/a");
  std::string many = "{";
  for (int i = 0; i < 100; ++i) many += "\"m" + std::to_string(i) + "\":0,";
  EXPECT_TRUE(Document::parse(many + "\"last\":0}").ok());
  EXPECT_EQ(parse_error(many + "\"m50\":0}").where, "/m50");
}

TEST(JsonReadTest, DepthIsCappedAt64) {
  const auto nested = [](std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); };
  EXPECT_TRUE(Document::parse(nested(64)).ok());
  EXPECT_EQ(parse_error(nested(65)).code, Code::kMalformed);
  EXPECT_EQ(parse_error(nested(1000000)).code, Code::kMalformed);
  std::string objects;
  for (int i = 0; i < 100000; ++i) objects += "{\"a\":";
  EXPECT_EQ(parse_error(objects).code, Code::kMalformed);
}

TEST(JsonReadTest, IntegersAreNeverConvertedSilently) {
  const Document document =
      Document::parse(
          R"([1e300, -1, 1.5, 9007199254740993, 18446744073709551615, 99999999999999999999, 3.0, "3", 1e2])")
          .value();
  std::vector<proto::Value> values;
  const proto::Array array = document.root().array(9).value();
  for (const proto::Value value : array) values.push_back(value);
  constexpr std::int64_t kMax = std::int64_t{1} << 53;
  EXPECT_EQ(values[0].integer(0, kMax).error().code, Code::kInvalidValue);
  EXPECT_EQ(values[1].integer(0, kMax).error().code, Code::kInvalidValue);
  EXPECT_EQ(values[1].integer(0, kMax).error().where, "/1");
  EXPECT_EQ(values[2].integer(0, kMax).error().code, Code::kMalformed);
  EXPECT_EQ(values[3].integer(0, kMax).error().code, Code::kInvalidValue);
  EXPECT_EQ(values[4].integer(0, kMax).error().code, Code::kInvalidValue);
  EXPECT_EQ(values[5].integer(0, kMax).error().code, Code::kInvalidValue);
  EXPECT_EQ(values[6].integer(0, kMax).value(), 3);
  EXPECT_EQ(values[7].integer(0, kMax).error().code, Code::kMalformed);
  EXPECT_EQ(values[8].integer(0, 99).error().code, Code::kInvalidValue);
  EXPECT_EQ(values[8].integer(0, 100).value(), 100);
}

TEST(JsonReadTest, WrongTypesMissingAndUnknownMembersSayWhere) {
  const Document document = Document::parse(R"({"a/b~":{"x":"1"},"l":[1,2,3]})").value();
  const auto inner = member(document, "a/b~").object({"x", "y"}).value();
  EXPECT_EQ(inner.require("x")->number().error().where, "/a~1b~0/x");
  EXPECT_EQ(inner.require("y").error().where, "/a~1b~0");
  EXPECT_NE(inner.require("y").error().message.find("\"y\""), std::string::npos);
  const Error unknown = member(document, "a/b~").object({"y"}).error();
  EXPECT_EQ(unknown.where, "/a~1b~0/x");
  EXPECT_NE(unknown.message.find("\"x\""), std::string::npos);
  EXPECT_EQ(member(document, "l").array(2).error().code, Code::kTooLarge);
  EXPECT_EQ(member(document, "l").array(3)->size(), 3U);
  EXPECT_EQ(member(document, "l").any_object().error().code, Code::kMalformed);
  EXPECT_EQ(document.root().array(1).error().where, "");
}

TEST(JsonReadTest, ErrorsDoNotRepeatHugeNames) {
  const std::string text = "{\"" + std::string(1000000, 'x') + "\":1}";
  const Document document = Document::parse(text).value();
  const Error error = document.root().object({"a"}).error();
  EXPECT_LT(error.message.size() + error.where.size(), 400U);
}

/// Texts of these pieces are JSON, or nearly, often enough.
std::string scrambled(support::Random& random) {
  static constexpr std::string_view kPieces[] = {"[",
                                                 "]",
                                                 "{",
                                                 "}",
                                                 ",",
                                                 ":",
                                                 "\"a\"",
                                                 "\"b\"",
                                                 "\"\\u00e9\"",
                                                 "\"\xc3\xa9\"",
                                                 "0",
                                                 "7",
                                                 "-",
                                                 "1.5",
                                                 ".",
                                                 "e",
                                                 "E+2",
                                                 "00",
                                                 "-0",
                                                 "18446744073709551616",
                                                 "123456789012345678",
                                                 "1e999",
                                                 "1e-999",
                                                 "true",
                                                 "false",
                                                 "null",
                                                 "nul",
                                                 " ",
                                                 "\n",
                                                 "\t",
                                                 "\"",
                                                 "\x01"};
  std::string text;
  const std::size_t pieces = 1 + random() % 9;
  for (std::size_t i = 0; i < pieces; ++i) text += kPieces[random() % std::size(kPieces)];
  return text;
}

/// What is plain is read another way than what is not: both take exactly what is JSON.
TEST(JsonReadTest, TakesExactlyWhatTheLibraryTakes) {
  support::Random random(support::seed());
  int taken = 0;
  for (int i = 0; i < 300'000; ++i) {
    const std::string text =
        i % 2 == 0 ? scrambled(random) : "[" + scrambled(random) + "," + scrambled(random) + "]";
    const auto document = Document::parse(text);
    const bool refused_for_more = !document && (document.error().code == Code::kNotFinite ||
                                                document.error().message.find("twice") != std::string::npos);
    EXPECT_TRUE(document.ok() == nlohmann::json::accept(text) || refused_for_more) << text;
    taken += document.ok() ? 1 : 0;
  }
  EXPECT_GT(taken, 3000);
}

TEST(JsonReadTest, NumbersAreReadToTheLastBit) {
  support::Random random(support::seed());
  for (int i = 0; i < 100'000; ++i) {
    std::string text = random() % 2 == 0 ? "-" : "";
    text += std::to_string(random() >> (random() % 64));
    if (random() % 2 == 0) text += "." + std::to_string(random() >> (random() % 64));
    if (random() % 3 == 0) text += "e" + std::to_string(static_cast<int>(random() % 640) - 320);
    const double expected = std::strtod(text.c_str(), nullptr);
    const auto document = Document::parse("[" + text + "]");
    if (std::isinf(expected)) {
      EXPECT_EQ(document.error().code, Code::kNotFinite) << text;
      continue;
    }
    ASSERT_TRUE(document.ok()) << text;
    const double value = (*document->root().array(1)->begin()).number().value();
    EXPECT_EQ(std::memcmp(&value, &expected, sizeof value) == 0 || (value == 0 && expected == 0), true)
        << text;
  }
}

}  // namespace
