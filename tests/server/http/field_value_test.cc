// What clients would rather have, as browsers and programs say it.
#include "server/http/field_value.h"

#include <gtest/gtest.h>

namespace {

using server::http::parse_preferences;
using server::http::prefers;

TEST(FieldValueTest, PreferencesHaveNamesAndWeights) {
  const auto items = parse_preferences(" Text/HTML ;level=1; q=0.5,, application/json;Q=0, */* ");
  ASSERT_TRUE(items.has_value());
  ASSERT_EQ(items->size(), 3U);
  EXPECT_EQ((*items)[0].name, "text/html");
  EXPECT_EQ((*items)[0].weight, 0.5);
  EXPECT_EQ((*items)[1].weight, 0);
  EXPECT_EQ((*items)[2].name, "*/*");
  EXPECT_EQ((*items)[2].weight, 1);
  EXPECT_TRUE(parse_preferences("")->empty());
  for (const char* field : {"a;q=2", "a;q=-1", "a;q=", "a;q=1e0", "a;q=nan", "a;q=0.5x"})
    EXPECT_FALSE(parse_preferences(field).has_value()) << field;
}

TEST(FieldValueTest, TheClosestRangeGivesTheWeight) {
  const char* field = "*/*;q=0.1, text/*;q=0.5, text/html;q=0";
  EXPECT_TRUE(prefers(field, "text/plain", "application/json"));
  EXPECT_TRUE(prefers(field, "application/json", "text/html"));
  EXPECT_FALSE(prefers(field, "text/html", "image/png"));
  EXPECT_FALSE(prefers("text/html", "application/json", "text/html"));
}

TEST(FieldValueTest, WeightsGoBeforeOrderAndOrderBeforeChance) {
  const auto html = [](const char* field) { return prefers(field, "text/html", "application/json"); };
  EXPECT_TRUE(html("text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8"));
  EXPECT_TRUE(html("application/json;q=0.5, text/html"));
  EXPECT_TRUE(html("text/html, application/json"));
  EXPECT_TRUE(html("text/html, */*"));
  EXPECT_FALSE(html("application/json, text/html"));
  EXPECT_FALSE(html("text/html;q=0.5, application/json"));
  EXPECT_FALSE(html("text/html;q=0, */*"));
  EXPECT_FALSE(html("*/*"));
  EXPECT_FALSE(html("text/html;q=0"));
  EXPECT_FALSE(html(""));
  EXPECT_FALSE(html("text/html;q=high"));
}

}  // namespace
