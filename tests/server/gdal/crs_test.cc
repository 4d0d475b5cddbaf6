#include "server/gdal/crs.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace server::gdal {
namespace {

using tin::base::Code;

TEST(CrsTest, TakesEveryUsualNameOfACode) {
  for (const char* name : {"EPSG:32617", "epsg:32617", "http://www.opengis.net/def/crs/EPSG/0/32617",
                           "https://www.opengis.net/def/crs/EPSG/9.9.1/32617", "urn:ogc:def:crs:EPSG::32617",
                           "urn:ogc:def:crs:EPSG:9.9:32617"}) {
    const auto crs = read_crs(name);
    ASSERT_TRUE(crs.ok()) << name << ": " << crs.error().message;
    EXPECT_EQ(crs->name, "EPSG:32617");
    EXPECT_FALSE(crs->scale.geographic);
    EXPECT_EQ(crs->scale.unit_m, 1);
    EXPECT_FALSE(crs->vertical.has_value());
  }
}

TEST(CrsTest, Crs84IsEpsg4326InGisOrder) {
  for (const char* name : {"OGC:CRS84", "http://www.opengis.net/def/crs/OGC/1.3/CRS84",
                           "urn:ogc:def:crs:OGC:1.3:CRS84", "EPSG:4326"}) {
    const auto crs = read_crs(name);
    ASSERT_TRUE(crs.ok()) << name;
    EXPECT_EQ(crs->name, "EPSG:4326");
    EXPECT_TRUE(crs->scale.geographic);
  }
}

TEST(CrsTest, KnowsUnitsOnTheGroundAndOfHeights) {
  EXPECT_NEAR(read_crs("EPSG:2994")->scale.unit_m, 0.3048, 1e-12);         // Oregon, international feet
  EXPECT_NEAR(read_crs("EPSG:2263")->scale.unit_m, 1200.0 / 3937, 1e-12);  // New York, US survey feet
  const auto metres = read_crs("EPSG:5698");                               // Lambert-93 + NGF-IGN69 height
  ASSERT_TRUE(metres.ok()) << metres.error().message;
  ASSERT_TRUE(metres->vertical.has_value());
  EXPECT_EQ(metres->vertical->name, "metre");
  const auto feet = read_crs("EPSG:8734");  // New York + NAVD88 height (ftUS)
  if (feet.ok() && feet->vertical) {
    EXPECT_EQ(feet->vertical->name, "US survey foot");
    EXPECT_NEAR(feet->vertical->metres, 1200.0 / 3937, 1e-12);
  }
}

TEST(CrsTest, WktOfAKnownCrsGetsItsCode) {
  const char* const utm =
      R"(PROJCS["WGS 84 / UTM zone 32N",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],)"
      R"(PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],)"
      R"(PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",9],PARAMETER["scale_factor",0.9996],)"
      R"(PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1]])";
  const auto crs = read_crs(utm);
  ASSERT_TRUE(crs.ok()) << crs.error().message;
  EXPECT_EQ(crs->name, "EPSG:32632");
}

TEST(CrsTest, WktOfItsOwnStaysWktAndIsReadAgain) {
  const char* const own =
      R"(PROJCS["site grid",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],)"
      R"(PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],)"
      R"(PARAMETER["latitude_of_origin",47.5],PARAMETER["central_meridian",8.125],PARAMETER["scale_factor",1],)"
      R"(PARAMETER["false_easting",1000],PARAMETER["false_northing",2000],UNIT["foot",0.3048]])";
  const auto crs = read_crs(own);
  ASSERT_TRUE(crs.ok()) << crs.error().message;
  EXPECT_EQ(crs->name.substr(0, 8), "PROJCRS[");
  EXPECT_EQ(crs->name.find('\n'), std::string::npos);
  EXPECT_NEAR(crs->scale.unit_m, 0.3048, 1e-12);
  const auto again = read_crs(crs->name);
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(again->name, crs->name);
}

TEST(CrsTest, ACodeThatTheDefinitionContradictsIsNotBelieved) {
  const auto crs =
      read_crs(R"(GEOGCS["WGS 84",DATUM["Mars",SPHEROID["Mars",3396190,169.89]],PRIMEM["Greenwich",0],)"
               R"(UNIT["degree",0.0174532925199433],AUTHORITY["EPSG","4326"]])");
  if (crs.ok()) {
    EXPECT_NE(crs->name, "EPSG:4326");
  }
}

TEST(CrsTest, RefusesWhatIsNone) {
  for (const char* name : {"", "EPSG:", "EPSG:x", "EPSG:-1", "EPSG:4326 ", "EPSG:99999999999", "32617",
                           "WGS84", "+proj=longlat", "/etc/passwd", "http://example.org/crs.wkt", "GEOGCS[",
                           "urn:ogc:def:crs:EPSG:4326", "http://www.opengis.net/def/crs/EPSG/0/"}) {
    const auto crs = read_crs(name);
    ASSERT_FALSE(crs.ok()) << name;
    EXPECT_EQ(crs.error().code, Code::kMalformed) << name;
  }
  EXPECT_EQ(read_crs("EPSG:999999").error().code, Code::kUnsupported);
  EXPECT_EQ(read_crs("EPSG:4978").error().code, Code::kUnsupported) << "geocentric";
  EXPECT_EQ(read_crs("EPSG:5773").error().code, Code::kUnsupported) << "vertical only";
  EXPECT_EQ(read_crs("EPSG:4807").error().code, Code::kUnsupported) << "grads";
}

TEST(CrsTransformTest, ConvertsInGisOrderAndBack) {
  auto there = CrsTransform::create("EPSG:4326", "EPSG:32632");
  auto back = CrsTransform::create("EPSG:32632", "OGC:CRS84");
  ASSERT_TRUE(there.ok() && back.ok());
  std::array x{9.0, 10.0};
  std::array y{0.0, 47.5};
  std::array<std::uint8_t, 2> ok{};
  EXPECT_TRUE(there->transform(x, y, ok));
  EXPECT_NEAR(x[0], 500000, 1e-6);
  EXPECT_NEAR(y[0], 0, 1e-6);
  EXPECT_NEAR(y[1], 5260000, 20000);
  EXPECT_TRUE(back->transform(x, y, ok));
  EXPECT_NEAR(x[1], 10, 1e-9);
  EXPECT_NEAR(y[1], 47.5, 1e-9);
}

TEST(CrsTransformTest, TellsWhichPositionsFail) {
  auto way = CrsTransform::create("EPSG:4326", "EPSG:3857");
  ASSERT_TRUE(way.ok());
  std::array x{8.0, std::nan(""), 8.0};
  std::array y{47.0, 1.0, 1000.0};
  std::array<std::uint8_t, 3> ok{};
  EXPECT_FALSE(way->transform(x, y, ok));
  EXPECT_EQ(ok, (std::array<std::uint8_t, 3>{1, 0, 0}));
  EXPECT_TRUE(std::isinf(x[1]));
  EXPECT_NEAR(x[0], 890555.93, 0.01);
}

TEST(CrsTransformTest, RefusesUnknownNames) {
  EXPECT_FALSE(CrsTransform::create("EPSG:4326", "nonsense").ok());
  EXPECT_FALSE(CrsTransform::create("EPSG:999999", "EPSG:4326").ok());
}

TEST(VerticalUnitTest, KnowsTheirManyNames) {
  EXPECT_EQ(vertical_unit("M")->name, "metre");
  EXPECT_EQ(vertical_unit("ft")->metres, 0.3048);
  EXPECT_EQ(vertical_unit("US survey foot")->metres, 1200.0 / 3937);
  EXPECT_FALSE(vertical_unit("").has_value());
  EXPECT_FALSE(vertical_unit("degC").has_value());
}

}  // namespace
}  // namespace server::gdal
