#include "server/http/url.h"

#include <gtest/gtest.h>

namespace tests::server_http {
namespace {

using server::http::parse_target;
using server::http::valid_utf8;

TEST(UrlTest, SegmentsAreDecodedOneByOne) {
  const auto target = parse_target("/tins/a%2Fb/%C3%A9");
  ASSERT_TRUE(target);
  EXPECT_EQ(target->segments, (std::vector<std::string>{"tins", "a/b", "\xc3\xa9"}));
  EXPECT_EQ(target->path, "/tins/a/b/\xc3\xa9");
}

TEST(UrlTest, TheRootHasOneEmptySegment) {
  EXPECT_EQ(parse_target("/")->segments, std::vector<std::string>{""});
}

TEST(UrlTest, QueryParametersKeepTheirOrder) {
  const auto target = parse_target("/a?b=1+2&c&&d=%26=%2B&b=3");
  ASSERT_TRUE(target);
  EXPECT_EQ(target->query, (server::http::NamedValues{{"b", "1 2"}, {"c", ""}, {"d", "&=+"}, {"b", "3"}}));
  EXPECT_EQ(target->path, "/a");
}

TEST(UrlTest, BadTargetsAreRefused) {
  for (const char* bad : {"", "a", "/%", "/%4", "/%zz", "/%00", "/%0a", "/%ff", "/%c0%af", "/%ed%a0%80",
                          "/a/../b", "/.", "/%2e%2e/x", "/a#b", "/a?b=%f", "/a?%00", "/a?b=%c3"}) {
    EXPECT_FALSE(parse_target(bad)) << bad;
  }
}

TEST(UrlTest, Utf8IsCheckedToItsEdges) {
  for (const char* good : {"", "a", "\xc2\x80", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf", "\xee\x80\x80",
                           "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf"}) {
    EXPECT_TRUE(valid_utf8(good)) << good;
  }
  for (const char* bad : {"\x80", "\xc1\xbf", "\xc2", "\xe0\x9f\xbf", "\xed\xa0\x80", "\xf0\x8f\xbf\xbf",
                          "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xe2\x82", "\xe2\x28\xa1"}) {
    EXPECT_FALSE(valid_utf8(bad)) << bad;
  }
}

}  // namespace
}  // namespace tests::server_http
