#include "proto/json_write.h"

#include <gtest/gtest.h>

#include <limits>

#include "proto/json_read.h"
#include "proto/utf8.h"

namespace {

std::string as_json(std::string_view text) {
  std::string out;
  proto::append_json_string(out, text);
  return out;
}

TEST(JsonWriteTest, CommasStandBetweenValues) {
  proto::JsonWriter json;
  json.begin_object().key("a").begin_array().integer(1).null().begin_object().end_object().end_array();
  json.key("b").string("x").key("c").begin_object().end_object().end_object();
  EXPECT_EQ(json.take(), R"({"a":[1,null,{}],"b":"x","c":{}})");
}

TEST(JsonWriteTest, NumbersThatAreNotFiniteBecomeNull) {
  proto::JsonWriter json;
  json.begin_array().number(std::numeric_limits<double>::quiet_NaN());
  json.number(-std::numeric_limits<double>::infinity()).number(0.1).end_array();
  EXPECT_EQ(json.take(), "[null,null,0.1]");
}

TEST(JsonWriteTest, StringsAreEscaped) {
  EXPECT_EQ(as_json("a\"\\\n\t\r\x01\x7f/"), R"("a\"\\\n\t\r\u0001\u007f/")");
  EXPECT_EQ(as_json("\xc3\xa9\xf0\x9f\x97\xbb"), "\"\xc3\xa9\xf0\x9f\x97\xbb\"");
}

TEST(JsonWriteTest, AnyBytesGiveAStringThatParses) {
  for (int first = 0; first < 256; ++first) {
    for (int second = 0; second < 256; ++second) {
      const std::string bytes = {static_cast<char>(first), static_cast<char>(second), '\x80', '"'};
      ASSERT_TRUE(proto::Document::parse(as_json(bytes)).ok()) << first << " " << second;
    }
  }
}

TEST(Utf8Test, KnowsWellFormedCharacters) {
  EXPECT_EQ(proto::utf8_length("a"), 1U);
  EXPECT_EQ(proto::utf8_length("\xc3\xa9"), 2U);
  EXPECT_EQ(proto::utf8_length("\xe2\x82\xac"), 3U);
  EXPECT_EQ(proto::utf8_length("\xf4\x8f\xbf\xbf"), 4U);
  for (const char* broken : {"", "\x80", "\xc0\xaf", "\xc3", "\xe0\x80\x80", "\xed\xa0\x80",
                             "\xf4\x90\x80\x80", "\xf5\x80\x80\x80"}) {
    EXPECT_EQ(proto::utf8_length(broken), 0U) << broken;
  }
}

TEST(Utf8Test, CutsBetweenCharacters) {
  EXPECT_EQ(proto::utf8_prefix("abc", 3), "abc");
  EXPECT_EQ(proto::utf8_prefix("ab\xc3\xa9", 3), "ab...");
  EXPECT_EQ(proto::utf8_prefix("\xff\xff\xff", 2), "\xff\xff...");
}

}  // namespace
