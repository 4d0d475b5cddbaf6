#include "proto/formats/geojson.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "tests/support/schema_check.h"

namespace {

using proto::Position;
using proto::VertexId;
using proto::formats::CollectionHead;
using proto::formats::Coordinates;
using proto::formats::GeoJsonWriter;

/// Four vertices around a diagonal: ids 2 and 3 are on it.
constexpr Position kCorners[] = {
    {7.8, 45.9, 2810.5}, {7.81, 45.9, 2811}, {7.8, 45.91, 2790}, {7.81, 45.91, -0.125}};

VertexId id(std::uint64_t value) {
  return VertexId(value);
}

TEST(GeoJsonTest, TwoTrianglesAsTheyMustBe) {
  std::string out;
  GeoJsonWriter writer(out, Coordinates::kDegrees);
  writer.begin({});
  writer.triangle({id(1), id(2), id(3)}, {kCorners[0], kCorners[1], kCorners[2]});
  writer.triangle({id(4), id(3), id(2)}, {kCorners[3], kCorners[2], kCorners[1]});
  writer.end();
  EXPECT_EQ(out, R"({"type":"FeatureCollection","features":[
{"type":"Feature","id":"1-2-3","geometry":{"type":"Polygon","coordinates":[[[7.8,45.9,2810.5],[7.81,45.9,2811],[7.8,45.91,2790],[7.8,45.9,2810.5]]]},"properties":{"vertices":[1,2,3]}},
{"type":"Feature","id":"2-4-3","geometry":{"type":"Polygon","coordinates":[[[7.81,45.9,2811],[7.81,45.91,-0.125],[7.8,45.91,2790],[7.81,45.9,2811]]]},"properties":{"vertices":[2,4,3]}}
]}
)");
  EXPECT_TRUE(tests_support::schema_violations("FeatureCollection", out).empty());
}

TEST(GeoJsonTest, APageOfVerticesAsItMustBe) {
  std::string out;
  GeoJsonWriter writer(out, Coordinates::kDegrees);
  CollectionHead head;
  head.number_matched = 4;
  head.number_returned = 2;
  head.links = {{"/tins/a/collections/vertices/items?next=t", "next", "application/geo+json", ""}};
  writer.begin(head);
  writer.vertex(id(1), kCorners[0]);
  writer.vertex(id(2), {1.0 / 3, -45, 1e-7});
  writer.end();
  EXPECT_EQ(
      out,
      R"({"type":"FeatureCollection","numberMatched":4,"numberReturned":2,"links":[{"href":"/tins/a/collections/vertices/items?next=t","rel":"next","type":"application/geo+json"}],"features":[
{"type":"Feature","id":1,"geometry":{"type":"Point","coordinates":[7.8,45.9,2810.5]},"properties":{"z":2810.5}},
{"type":"Feature","id":2,"geometry":{"type":"Point","coordinates":[0.333333333,-45,1e-07]},"properties":{"z":1e-07}}
]}
)");
  EXPECT_TRUE(
      tests_support::violations("GET", "/tins/{tin}/collections/{collection}/items", 200, out).empty());
}

TEST(GeoJsonTest, NothingAtAllIsAnEmptyCollection) {
  std::string out;
  GeoJsonWriter writer(out, Coordinates::kProjected);
  CollectionHead head;
  head.crs_urn = "urn:ogc:def:crs:EPSG::32617";
  writer.begin(head);
  writer.end();
  EXPECT_EQ(
      out,
      R"({"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::32617"}},)"
      "\"features\":[\n]}\n");
  EXPECT_TRUE(tests_support::schema_violations("FeatureCollection", out).empty());
}

TEST(GeoJsonTest, ExactCoordinatesAndTheLatticeTheyLieOn) {
  std::string out;
  GeoJsonWriter writer(out, Coordinates::kExact);
  CollectionHead head;
  head.frame_note = R"({"crs":""})";
  writer.begin(head);
  writer.vertex(id(1), {1.0 / 3, 1e-12, 2});
  writer.end();
  EXPECT_EQ(out, R"({"type":"FeatureCollection","tinsmith-frame":{"crs":""},"features":[
{"type":"Feature","id":1,"geometry":{"type":"Point","coordinates":[0.3333333333333333,1e-12,2]},"properties":{"z":2.0}}
]}
)");
  EXPECT_TRUE(tests_support::schema_violations("FeatureCollection", out).empty());
}

TEST(GeoJsonTest, ATriangleHasTheSameBytesFromAnyCorner) {
  const auto written = [](std::size_t first) {
    const std::array<VertexId, 3> ids = {id(30), id(2), id(17)};
    std::string out;
    GeoJsonWriter writer(out, Coordinates::kProjected);
    writer.triangle({ids[first], ids[(first + 1) % 3], ids[(first + 2) % 3]},
                    {kCorners[first], kCorners[(first + 1) % 3], kCorners[(first + 2) % 3]});
    return out;
  };
  EXPECT_EQ(written(0), written(1));
  EXPECT_EQ(written(0), written(2));
  EXPECT_NE(written(0).find("\"2-17-30\""), std::string::npos);
  EXPECT_EQ(proto::formats::triangle_id({id(30), id(2), id(17)}), "2-17-30");
}

TEST(GeoJsonTest, TheTextMayBeTakenPieceByPiece) {
  std::string whole, out, pieces;
  GeoJsonWriter at_once(whole, Coordinates::kProjected), in_pieces(out, Coordinates::kProjected);
  at_once.begin({});
  in_pieces.begin({});
  for (std::uint64_t i = 1; i <= 100; ++i) {
    const Position at{500000.0 + static_cast<double>(i) / 8, 4500000.0, static_cast<double>(i)};
    at_once.vertex(id(i), at);
    in_pieces.vertex(id(i), at);
    pieces += out;
    out.clear();
  }
  at_once.end();
  in_pieces.end();
  EXPECT_EQ(pieces + out, whole);
}

TEST(GeoJsonTest, AMillionVerticesAreWrittenQuickly) {
  std::string out;
  GeoJsonWriter writer(out, Coordinates::kDegrees);
  const auto start = std::chrono::steady_clock::now();
  std::size_t bytes = 0;
  for (std::uint64_t i = 1; i <= 1000000; ++i) {
    const double along = static_cast<double>(i);
    writer.vertex(id(i), {-72 + along / 1.3e6, 44 + along / 1.7e6, 300 + std::fmod(along / 7, 1000)});
    if (out.size() > 65536) {
      bytes += out.size();
      out.clear();
    }
  }
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  RecordProperty("vertices_per_second", static_cast<int>(1e6 / seconds.count()));
  EXPECT_GT(bytes, 100000000U);
  EXPECT_LT(seconds.count(),
            20);  // generous: sanitizers and busy machines; a release build needs less than 1 s
}

}  // namespace
