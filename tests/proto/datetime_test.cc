#include "proto/datetime.h"

#include <gtest/gtest.h>

namespace proto {
namespace {

TimeSpan span_of(const std::string& text) {
  const auto span = parse_datetime(text, "query:datetime");
  EXPECT_TRUE(span.ok()) << text;
  return span ? *span : TimeSpan{};
}

constexpr std::int64_t kNoon = 1'518'436'800'000;  // 2018-02-12T12:00:00Z

TEST(DatetimeTest, AMomentIsItsSecondAndADateItsDay) {
  EXPECT_EQ(span_of("2018-02-12T12:00:00Z").from_ms, kNoon);
  EXPECT_EQ(span_of("2018-02-12T12:00:00Z").until_ms, kNoon + 999);
  EXPECT_EQ(span_of("2018-02-12t13:30:00.25+01:30").from_ms, kNoon + 250);
  EXPECT_EQ(span_of("2018-02-12T11:59:59.9999-00:00").until_ms, kNoon - 1);
  EXPECT_EQ(span_of("1970-01-01T00:00:00z").from_ms, 0);
  EXPECT_EQ(span_of("2016-12-31T23:59:60Z").from_ms, span_of("2017-01-01T00:00:00Z").from_ms)
      << "a leap second";
  EXPECT_EQ(span_of("2018-02-12T12:00Z").until_ms, kNoon + 59'999);
  EXPECT_EQ(span_of("2018-02-12").from_ms, kNoon - 12 * 3'600'000);
  EXPECT_EQ(span_of("2018-02-12").until_ms, kNoon + 12 * 3'600'000 - 1);
  EXPECT_EQ(span_of("2024-02-29").from_ms, 1'709'164'800'000);
}

TEST(DatetimeTest, IntervalsMayBeOpen) {
  EXPECT_TRUE(span_of("2018-02-12T12:00:00Z/..").contains(kNoon));
  EXPECT_FALSE(span_of("2018-02-12T12:00:00Z/").contains(kNoon - 1));
  EXPECT_TRUE(span_of("../2018-02-12T12:00:00Z").contains(kNoon));
  EXPECT_FALSE(span_of("../2018-02-12T12:00:00Z").contains(kNoon + 1000));
  EXPECT_TRUE(span_of("../..").contains(kNoon));
  EXPECT_TRUE(span_of("2018-02-11/2018-02-13").contains(kNoon));
}

TEST(DatetimeTest, OtherTextsAreRefused) {
  for (const char* text : {"",
                           "yesterday",
                           "2018",
                           "2018-02",
                           "2018-2-12",
                           "2018-02-30",
                           "2018-13-01",
                           "2018-02-12T",
                           "2018-02-12T12Z",
                           "2018-02-12T12:00.5Z",
                           "2018-02-12T24:00:00Z",
                           "2018-02-12T12:60:00Z",
                           "2018-02-12T12:00:00",
                           "2018-02-12T12:00:00.Z",
                           "2018-02-12T12:00:00+1:00",
                           "2018-02-12T12:00:00Zx",
                           "2018-02-13/2018-02-12",
                           "a/b",
                           "2018-02-12/x",
                           "-018-02-12",
                           "2018-02--1",
                           "2018-02-12/2018-02-13/2018-02-14"}) {
    EXPECT_FALSE(parse_datetime(text, "query:datetime").ok()) << text;
  }
}

}  // namespace
}  // namespace proto
