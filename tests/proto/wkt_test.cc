#include "proto/wkt.h"

#include <gtest/gtest.h>

namespace proto {
namespace {

using Kind = WktGeometry::Kind;
using tin::base::Code;

WktGeometry read(const std::string& text) {
  const auto found = parse_wkt(text, 100, "query:coords");
  EXPECT_TRUE(found.ok()) << text << (found ? "" : ": " + found.error().message);
  return found ? *found : WktGeometry{};
}

TEST(WktTest, ReadsEveryKindInLettersOfAnyCase) {
  EXPECT_EQ(read("POINT(7 46)").parts, (std::vector<std::vector<WktGeometry::Sequence>>{{{{7, 46}}}}));
  EXPECT_EQ(read("  point ( -7.5e0\t46 ) ").parts[0][0][0], (Position2{-7.5, 46}));
  EXPECT_EQ(read("MULTIPOINT((1 2),(3 4))").parts, read("MultiPoint(1 2, 3 4)").parts);
  EXPECT_EQ(read("MULTIPOINT(1 2)").kind, Kind::kMultiPoint);
  EXPECT_EQ(read("LINESTRING(1 2,3 4,5 6)").parts[0][0].size(), 3U);
  const auto lines = read("MULTILINESTRING((1 2,3 4),(5 6,7 8,9 10))");
  EXPECT_EQ(lines.kind, Kind::kMultiLineString);
  ASSERT_EQ(lines.parts.size(), 2U);
  EXPECT_EQ(lines.parts[1][0].size(), 3U);
  const auto polygon = read("POLYGON((0 0,9 0,9 9,0 0),(5 1,6 1,6 2,5 1))");
  ASSERT_EQ(polygon.parts.size(), 1U);
  EXPECT_EQ(polygon.parts[0].size(), 2U) << "a hole";
  EXPECT_EQ(read("MULTIPOLYGON(((0 0,9 0,9 9,0 0)),((0 1,1 1,1 2,0 1)))").parts.size(), 2U);
}

TEST(WktTest, RefusesWhatIsNone) {
  for (const char* text : {"",
                           " ",
                           "POINT",
                           "POINT()",
                           "POINT(1)",
                           "POINT(1 2 3)",
                           "POINT(1,2)",
                           "POINT(1 2",
                           "POINT 1 2",
                           "POINT(1 2))",
                           "POINT(1 2) x",
                           "POINT EMPTY",
                           "POINT Z(1 2 3)",
                           "POINTZ(1 2 3)",
                           "POINT(1 2,3 4)",
                           "POINT(0x1 2)",
                           "LINESTRING(1 2)",
                           "LINESTRING((1 2,3 4))",
                           "MULTILINESTRING(1 2,3 4)",
                           "POLYGON((0 0,1 0,0 0))",
                           "POLYGON((0 0,1 0,1 1,0 1))",
                           "POLYGON(0 0,1 0,1 1,0 0)",
                           "MULTIPOINT((1 2)",
                           "MULTIPOINT((1 2,3 4))",
                           "GEOMETRYCOLLECTION(POINT(1 2))",
                           "SRID=4326;POINT(1 2)"}) {
    const auto found = parse_wkt(text, 100, "query:coords");
    ASSERT_FALSE(found.ok()) << text;
    EXPECT_EQ(found.error().code, Code::kMalformed) << text;
    EXPECT_EQ(found.error().where, "query:coords");
  }
  EXPECT_EQ(parse_wkt("POINT(1 1e999)", 100, "").error().code, Code::kNotFinite);
}

TEST(WktTest, CountsPositions) {
  EXPECT_TRUE(parse_wkt("MULTILINESTRING((1 2,3 4),(5 6,7 8))", 4, "").ok());
  EXPECT_EQ(parse_wkt("MULTILINESTRING((1 2,3 4),(5 6,7 8))", 3, "").error().code, Code::kTooLarge);
}

}  // namespace
}  // namespace proto
