#include "proto/numbers.h"

#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "proto/bbox.h"
#include "proto/crs_uri.h"

namespace {

using tin::base::Code;

std::string shortest(double value) {
  std::string out;
  proto::append_shortest(out, value);
  return out;
}

std::string rounded(double value, int decimals) {
  std::string out;
  proto::append_rounded(out, value, decimals);
  return out;
}

TEST(NumbersTest, ShortestIsPlainInTheUsualRange) {
  EXPECT_EQ(shortest(500000), "500000");
  EXPECT_EQ(shortest(0.1), "0.1");
  EXPECT_EQ(shortest(-0.0), "0");
  EXPECT_EQ(shortest(0.00001), "0.00001");
  EXPECT_EQ(shortest(1e-6), "1e-06");
  EXPECT_EQ(shortest(1e15), "1e+15");
  EXPECT_EQ(shortest(4633.5), "4633.5");
}

TEST(NumbersTest, ShortestReadsBackBitForBit) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  for (int i = 0; i < 100000; ++i) {
    const std::uint64_t bits = random();
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value) || value == 0) continue;
    const std::string text = shortest(value);
    double back = 0;
    std::from_chars(text.data(), text.data() + text.size(), back);
    ASSERT_EQ(back, value) << text;
  }
  EXPECT_EQ(shortest(std::numeric_limits<double>::denorm_min()), "5e-324");
  EXPECT_EQ(shortest(std::numeric_limits<double>::max()), "1.7976931348623157e+308");
}

TEST(NumbersTest, RoundedTrimsZeros) {
  EXPECT_EQ(rounded(-71.5, 9), "-71.5");
  EXPECT_EQ(rounded(1.0 / 3, 9), "0.333333333");
  EXPECT_EQ(rounded(179.9999999999, 9), "180");
  EXPECT_EQ(rounded(-0.00000000001, 9), "0");
  EXPECT_EQ(rounded(-0.0001, 4), "-0.0001");
  EXPECT_EQ(rounded(500000.12345, 4), "500000.1235");
  EXPECT_EQ(rounded(2.5, 0), "3");
  EXPECT_EQ(rounded(7, 4), "7");
  EXPECT_EQ(rounded(1e20, 9), "1e+20");
}

TEST(QueryTest, CountsAreWholeNumbersInRange) {
  EXPECT_EQ(proto::parse_count("10", 1, 10, "query:limit").value(), 10U);
  EXPECT_EQ(proto::parse_count("0", 0, 10, "query:limit").value(), 0U);
  for (const char* text : {"", "-1", "+1", "1.5", "1e3", " 1", "1 ", "0x10", "ten"}) {
    EXPECT_EQ(proto::parse_count(text, 0, 10, "q").error().code, Code::kMalformed) << text;
  }
  for (const char* text : {"11", "18446744073709551616", "99999999999999999999999"}) {
    EXPECT_EQ(proto::parse_count(text, 0, 10, "q").error().code, Code::kInvalidValue) << text;
  }
  EXPECT_EQ(proto::parse_count("0", 1, 10, "query:limit").error().where, "query:limit");
}

TEST(QueryTest, NumbersAreFiniteAndWhole) {
  EXPECT_EQ(proto::parse_number("-1.5e2", "q").value(), -150);
  for (const char* text : {"", "1,5", "1.5x", " 1", "0x1p3", "--1"}) {
    EXPECT_EQ(proto::parse_number(text, "q").error().code, Code::kMalformed) << text;
  }
  for (const char* text : {"nan", "inf", "-inf", "infinity", "1e999"}) {
    EXPECT_EQ(proto::parse_number(text, "q").error().code, Code::kNotFinite) << text;
  }
}

TEST(QueryTest, BoxesHaveFourOrSixNumbers) {
  EXPECT_EQ(proto::parse_bbox("1,2,3,4.5", "q").value(), (proto::Bbox{1, 2, 3, 4.5, {}, {}}));
  EXPECT_EQ(proto::parse_bbox("1,2,-5,3,4,9", "q").value(), (proto::Bbox{1, 2, 3, 4, -5, 9}));
  EXPECT_TRUE(proto::parse_bbox("1,1,1,1", "q").ok());
  for (const char* text :
       {"", "1", "1,2,3", "1,2,3,4,5", "1,2,3,4,5,6,7", "1,2,3,4,", ",1,2,3", "1,2,3,a", "1;2;3;4"}) {
    EXPECT_EQ(proto::parse_bbox(text, "q").error().code, Code::kMalformed) << text;
  }
  EXPECT_EQ(proto::parse_bbox("1,2,nan,4", "q").error().code, Code::kNotFinite);
  for (const char* text : {"3,2,1,4", "1,4,3,2", "1,2,9,3,4,5"}) {
    EXPECT_EQ(proto::parse_bbox(text, "q").error().code, Code::kInvalidValue) << text;
  }
  EXPECT_EQ(proto::parse_bbox("1", "query:bbox").error().where, "query:bbox");
}

TEST(CrsUriTest, AllFormsOfANameAreOne) {
  for (const char* text : {"EPSG:32617", "epsg:32617", "http://www.opengis.net/def/crs/EPSG/0/32617",
                           "https://www.opengis.net/def/crs/EPSG/9.9.1/32617", "urn:ogc:def:crs:EPSG::32617",
                           "urn:ogc:def:crs:EPSG:9.9:32617", "URN:X-OGC:DEF:CRS:EPSG::32617"}) {
    ASSERT_TRUE(proto::parse_crs(text, "q").ok()) << text;
    EXPECT_EQ(proto::parse_crs(text, "q").value(), "EPSG:32617");
  }
  for (const char* text : {"OGC:CRS84", "http://www.opengis.net/def/crs/OGC/1.3/CRS84",
                           "urn:ogc:def:crs:OGC:1.3:CRS84", "urn:ogc:def:crs:OGC::CRS84"}) {
    ASSERT_TRUE(proto::parse_crs(text, "q").ok()) << text;
    EXPECT_EQ(proto::parse_crs(text, "q").value(), "OGC:CRS84");
  }
}

TEST(CrsUriTest, OtherTextsAreRefused) {
  for (const char* text :
       {"", "EPSG", "EPSG:", "EPSG:abc", "EPSG:-1", "EPSG:0", "EPSG:4326 ", "EPSG:1234567890", "32617",
        "http://www.opengis.net/def/crs/EPSG/32617", "http://evil.example/def/crs/EPSG/0/32617",
        "urn:ogc:def:crs:EPSG:32617", "urn:ogc:def:crs:EPSG::", "PROJCRS[\"x\"]", "/vsicurl/x", "ESRI:102003",
        "OGC:CRS27"}) {
    const auto crs = proto::parse_crs(text, "query:crs");
    ASSERT_FALSE(crs.ok()) << text;
    EXPECT_EQ(crs.error().code, Code::kMalformed);
    EXPECT_EQ(crs.error().where, "query:crs");
  }
}

TEST(CrsUriTest, NamesBecomeUrisAndBack) {
  EXPECT_EQ(proto::crs_uri("EPSG:4326"), "http://www.opengis.net/def/crs/EPSG/0/4326");
  EXPECT_EQ(proto::crs_urn("EPSG:4326"), "urn:ogc:def:crs:EPSG::4326");
  EXPECT_EQ(proto::crs_uri("OGC:CRS84"), proto::kCrs84Uri);
  EXPECT_EQ(proto::crs_urn("OGC:CRS84"), "urn:ogc:def:crs:OGC:1.3:CRS84");
  EXPECT_FALSE(proto::crs_uri("").has_value());
  EXPECT_FALSE(proto::crs_urn("GEOGCRS[\"WGS 84\"]").has_value());
  EXPECT_EQ(proto::parse_crs(*proto::crs_uri("EPSG:4326"), "q").value(), "EPSG:4326");
  EXPECT_EQ(proto::parse_crs(*proto::crs_urn("OGC:CRS84"), "q").value(), "OGC:CRS84");
}

}  // namespace
