#include "proto/formats/las.h"

#include <bit>
#include <random>

#include "proto/formats/little_endian.h"
#include "tests/proto/formats/las_file.h"
#include "tests/proto/formats/support.h"

namespace tests::formats {
namespace {

using namespace proto::formats;
using proto::Position;
using tin::base::Code;

tin::base::Result<LasFile> read(const std::string& bytes, const std::vector<std::size_t>& classes = {},
                                const ReadLimits& limits = {}) {
  LasClasses wanted;
  for (const std::size_t one : classes) wanted.set(one);
  if (classes.empty()) wanted.set();
  MemoryReader reader(bytes);
  return read_las(reader, wanted, limits);
}

Code refused(const std::string& bytes, const ReadLimits& limits = {}) {
  const auto las = read(bytes, {}, limits);
  EXPECT_FALSE(las.ok());
  return las ? Code::kInternal : las.error().code;
}

const std::vector<LasPoint> kThree{{100, -200, 12345, 2, false}, {-7, 8, 9, 5, false}, {1, 2, 3, 2, true}};

TEST(LasTest, EveryVersionAndPointFormat) {
  for (int minor = 0; minor <= 4; ++minor) {
    for (int format = 0; format <= (minor < 4 ? 5 : 10); ++format) {
      SCOPED_TRACE(std::to_string(minor) + ", " + std::to_string(format));
      const auto las = read(las_file({.minor = minor, .format = format, .points = kThree}));
      ASSERT_TRUE(las.ok()) << las.error().message;
      // The third is withheld.
      EXPECT_EQ(las->mesh.points, (std::vector<Position>{{500000 + 1.0, 4100000 - 2.0, 123.45},
                                                         {500000 - 0.07, 4100000 + 0.08, 0.09}}));
      EXPECT_EQ(las->withheld, 1U);
    }
  }
}

TEST(LasTest, ClassesAreChosen) {
  for (const int format : {1, 7}) {
    const std::string bytes = las_file({.minor = 4, .format = format, .points = kThree});
    EXPECT_EQ(read(bytes, {2})->mesh.points.size(), 1U);
    EXPECT_EQ(read(bytes, {2})->others, 1U);
    EXPECT_EQ(read(bytes, {2, 5})->mesh.points.size(), 2U);
    EXPECT_EQ(read(bytes, {9})->mesh.points.size(), 0U);
  }
  // Of an early point only five bits are the class: the sixth says that it is synthetic.
  const std::string late = las_file({.minor = 4, .format = 6, .points = {{1, 2, 3, 200, false}}});
  EXPECT_EQ(read(late, {200})->mesh.points.size(), 1U);
  std::string early = las_file({.minor = 2, .format = 0, .points = {{1, 2, 3, 2 | 0x20, false}}});
  EXPECT_EQ(read(early, {2})->mesh.points.size(), 1U);
}

TEST(LasTest, TheCrsIsFoundInEveryPlace) {
  const std::string wkt = "PROJCS[\"somewhere\"]";
  LasSpec spec{.minor = 4, .format = 6, .points = kThree};
  spec.records.push_back({"else", 2112, "nothing"});
  spec.records.push_back({"LASF_Projection", 34735, std::string("\1\0\1\0\0\0\0\0", 8)});
  std::string doubles;
  append_little(doubles, std::bit_cast<std::uint64_t>(0.25));
  spec.records.push_back({"LASF_Projection", 34736, doubles});
  spec.records.push_back({"LASF_Projection", 34737, "text|"});
  const auto tags = read(las_file(spec));
  ASSERT_TRUE(tags.ok());
  EXPECT_EQ(tags->geo_keys, (std::vector<std::uint16_t>{1, 1, 0, 0}));
  EXPECT_EQ(tags->geo_doubles, (std::vector<double>{0.25}));
  EXPECT_EQ(tags->geo_ascii, "text|");
  EXPECT_EQ(tags->mesh.crs, "");
  spec.records.push_back({"LASF_Projection", 2112, wkt + '\0'});
  EXPECT_EQ(read(las_file(spec))->mesh.crs, wkt);
  spec.records.clear();
  spec.extended = {{"LASF_Projection", 2112, wkt}};
  EXPECT_EQ(read(las_file(spec))->mesh.crs, wkt);
  spec.gap = 17;  // bytes of somebody else between header, records and points
  EXPECT_EQ(read(las_file(spec))->mesh.points.size(), 2U);
}

TEST(LasTest, WhatIsNotWhatItSaysIsRefused) {
  const std::string good = las_file({.minor = 2, .format = 3, .points = kThree});
  ASSERT_TRUE(read(good).ok());
  const auto with = [&good](std::size_t at, std::string_view bytes) {
    std::string bad = good;
    bad.replace(at, bytes.size(), bytes);
    return bad;
  };
  EXPECT_EQ(refused(""), Code::kMalformed);
  EXPECT_EQ(refused("LASF"), Code::kMalformed);
  EXPECT_EQ(refused(with(0, "LASX")), Code::kMalformed);
  EXPECT_EQ(refused(with(24, "\2")), Code::kUnsupported);
  EXPECT_EQ(refused(with(25, "\5")), Code::kUnsupported);
  EXPECT_EQ(refused(with(104, "\x83")), Code::kUnsupported);  // LAZ
  EXPECT_EQ(refused(with(104, "\x0B")), Code::kUnsupported);
  EXPECT_EQ(refused(with(105, std::string("\x21\0", 2))), Code::kMalformed);
  EXPECT_EQ(refused(with(94, std::string("\1\0", 2))), Code::kMalformed);
  EXPECT_EQ(refused(with(94, "\xFF\xFF")), Code::kMalformed);
  EXPECT_EQ(refused(with(96, "\xFF\xFF\xFF\xFF")), Code::kMalformed);
  EXPECT_EQ(refused(with(96, std::string("\0\0\0\0", 4))), Code::kMalformed);
  EXPECT_EQ(refused(with(100, "\xFF\xFF\xFF\xFF")), Code::kMalformed);
  EXPECT_EQ(refused(with(107, "\xFF\xFF\xFF\xFF")), Code::kMalformed);
  EXPECT_EQ(refused(with(107, std::string("\4\0\0\0", 4))), Code::kMalformed);
  EXPECT_EQ(refused(with(131, std::string(8, '\0'))), Code::kMalformed);
  EXPECT_EQ(refused(with(131, "\xFF\xFF\xFF\xFF\xFF\xFF\xEF\x7F")), Code::kNotFinite);  // times 12345
  EXPECT_EQ(refused(with(155, "\xFF\xFF\xFF\xFF\xFF\xFF\xFF\x7F")), Code::kMalformed);
  EXPECT_EQ(refused(good.substr(0, good.size() - 1)), Code::kMalformed);
  EXPECT_EQ(refused(good, {.points = 1, .check = {}}), Code::kTooLarge);
  const auto stop = [](std::uint64_t) {
    return tin::base::Result<void>(tin::base::error(Code::kCancelled, ""));
  };
  EXPECT_EQ(refused(good, {.points = 10, .check = stop}), Code::kCancelled);
}

TEST(LasTest, RecordsThatLieAreRefused) {
  LasSpec spec{.minor = 4, .format = 6, .points = kThree};
  spec.records.push_back({"LASF_Projection", 2112, "WKT"});
  std::string bytes = las_file(spec);
  bytes.replace(375 + 20, 2, "\xFF\xFF");
  EXPECT_EQ(refused(bytes), Code::kMalformed);
  spec.records.clear();
  spec.extended = {{"LASF_Projection", 2112, "WKT"}};
  bytes = las_file(spec);
  bytes.replace(bytes.size() - 3 - 60 + 20, 8, "\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF");
  EXPECT_EQ(refused(bytes), Code::kMalformed);
}

TEST(LasTest, DamageIsNeverWorseThanAnError) {
  LasSpec spec{.minor = 4, .format = 7, .points = std::vector<LasPoint>(50, LasPoint{1, 2, 3, 2, false})};
  spec.records.push_back({"LASF_Projection", 2112, "WKT"});
  spec.extended = {{"LASF_Projection", 2112, "WKT"}};
  const std::string whole = las_file(spec);
  std::mt19937 random(11);
  for (int round = 0; round < 5000; ++round) {
    std::string bytes = whole;
    for (int i = 0; i < 3; ++i)
      bytes[random() % (round % 2 == 0 ? 375 : bytes.size())] = static_cast<char>(random());
    if (round % 5 == 0) bytes.resize(random() % bytes.size());
    const auto las = read(bytes, {}, {.points = 100, .check = {}});
    EXPECT_TRUE(!las || las->mesh.points.size() <= 100);
  }
}

}  // namespace
}  // namespace tests::formats
