// What a decoder sends: whole it is the import, and whatever else it may be, an error.
#include "server/gdal/import_wire.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace server::gdal::testing {
namespace {

using tin::base::Code;
using tin::base::Result;
using tin::terrain::SourceGrid;

Import sample() {
  Import import;
  import.frame.crs = "EPSG:32632";
  import.frame.x = {500000, 10, 1000};
  import.frame.y = {5000000, 10, 1000};
  import.frame.vertical_unit = "metre";
  import.driver = "GTiff";
  import.bands = 2;
  for (int i = 0; i < 6; ++i) import.placements.push_back({{1000 * (i % 3), -1000 * (i / 3)}, 0.5 * i});
  import.grid = std::make_shared<SourceGrid>(
      SourceGrid{3, 2, 0, 0, 1000, -1000, {5e5, 10, 0, 5e6, 0, -10}, -9999.0, "Int16", {
                   0b111111
                 }});
  import.heights.stored = tin::base::Array<std::int16_t>{0, 1, 2, 3, 4, 5};
  import.heights.shift = 1;
  return import;
}

template <class Send>
std::string sent(Send send) {
  std::string bytes;
  EXPECT_TRUE(send([&](std::string_view piece) {
    bytes += piece;
    return true;
  }));
  return bytes;
}

ImportOptions limits(std::uint64_t samples, std::uint64_t pixels) {
  ImportOptions options;
  options.max_samples = samples;
  options.max_pixels = pixels;
  return options;
}

/// What becomes of these bytes; an error if they are not whole.
Result<Import> received(std::string_view bytes, const ImportOptions& options = limits(6, 6)) {
  ImportReceiver receiver(options, nullptr);
  if (auto taken = receiver.take(bytes); !taken) return taken.error();
  if (!receiver.whole()) return tin::base::error(Code::kMalformed, "not whole");
  return std::move(receiver).outcome();
}

std::string sent_import(const Import& import) {
  return sent([&](const Sink& sink) { return send_import(import, sink); });
}

TEST(ImportWireTest, AnImportArrivesAsItWas) {
  const Import import = sample();
  const auto there = received(sent_import(import));
  ASSERT_TRUE(there) << there.error().message;
  EXPECT_EQ(there->frame, import.frame);
  EXPECT_EQ(there->placements, import.placements);
  EXPECT_EQ(there->driver, import.driver);
  EXPECT_EQ(there->bands, import.bands);
  EXPECT_EQ(*there->grid, *import.grid);
  EXPECT_EQ(there->heights.stored, import.heights.stored);
  EXPECT_EQ(there->heights.shift, 1);
}

TEST(ImportWireTest, PiecesOfAnySizeWillDo) {
  const std::string bytes = sent_import(sample());
  for (const std::size_t step : {1, 3, 64}) {
    ImportReceiver receiver(limits(6, 6), nullptr);
    for (std::size_t i = 0; i < bytes.size(); i += step)
      ASSERT_TRUE(receiver.take(std::string_view(bytes).substr(i, step)));
    ASSERT_TRUE(receiver.whole());
    EXPECT_EQ(std::move(receiver).outcome()->placements, sample().placements);
  }
}

TEST(ImportWireTest, LargeImportsTravelInManyFrames) {
  Import import = sample();
  import.grid = nullptr;
  import.heights = {};
  import.placements.resize(200'000, {{5, 6}, 7});
  const auto there = received(sent_import(import), limits(200'000, 1));
  ASSERT_TRUE(there);
  EXPECT_EQ(there->placements, import.placements);
}

/// The sample as one who sends row by row sends it; NaN where its mask says so.
std::string sent_in_rows(const std::vector<double>& heights) {
  Import head = sample();
  head.placements.clear();
  head.heights = {};
  head.grid->valid.clear();
  return sent([&](const Sink& sink) {
    return send_beginning(head, sink) && send_rows(std::span(heights).first(heights.size() / 2), sink) &&
           send_rows(std::span(heights).subspan(heights.size() / 2), sink) && send_end(sink);
  });
}

TEST(ImportWireTest, HeightsMayTravelRowByRow) {
  constexpr double kVoid = std::numeric_limits<double>::quiet_NaN();
  const auto some = received(sent_in_rows({0, 0.5, kVoid, 1.5, 2, 70000}));
  ASSERT_TRUE(some) << some.error().message;
  EXPECT_EQ(some->grid->valid, std::vector<std::uint64_t>{0b111011});
  EXPECT_EQ(some->heights.size(), 6U);
  EXPECT_EQ(some->heights.at(5), 70000);
  EXPECT_EQ(some->heights.at(1), 0.5);
  EXPECT_TRUE(some->placements.empty());
  const auto all = received(sent_in_rows({0, 1, 2, 3, 4, 5}));
  ASSERT_TRUE(all);
  EXPECT_TRUE(all->grid->valid.empty());
  EXPECT_EQ(all->heights.stored.index(), 0U);
  for (const std::vector<double>& wrong :
       std::vector<std::vector<double>>{{0, 1, 2, 3, 4},
                                        {0, 1, 2, 3, 4, 5, 6},
                                        {0, 1, 2, 3, 4, std::numeric_limits<double>::infinity()},
                                        {kVoid, kVoid, kVoid, kVoid, kVoid, kVoid}}) {
    EXPECT_EQ(received(sent_in_rows(wrong)).error().code, Code::kMalformed);
  }
  EXPECT_FALSE(received(sent_in_rows({0, 1, 2, 3, 4, 5}), limits(6, 5))) << "more pixels than allowed";
}

TEST(ImportWireTest, ErrorsAndOptionsTravel) {
  const auto problem = received(sent([](const Sink& sink) {
    return send_error(tin::base::error(Code::kNotFinite, "line 3", "line 3"), sink);
  }));
  ASSERT_FALSE(problem);
  EXPECT_EQ(problem.error().code, Code::kNotFinite);
  EXPECT_EQ(problem.error().where, "line 3");
  ImportOptions options;
  options.file_name = "a.csv";
  options.resolution_y = 0.25;
  options.classes = {2, 200};
  options.max_unpacked_bytes = 9;
  options.max_pixels = 7;
  options.heights_only = true;
  const auto there = decode_options(encode_options(options));
  ASSERT_TRUE(there);
  EXPECT_EQ(there->file_name, "a.csv");
  EXPECT_EQ(there->resolution_y, 0.25);
  EXPECT_EQ(there->classes, options.classes);
  EXPECT_EQ(there->max_unpacked_bytes, 9U);
  EXPECT_EQ(there->max_pixels, 7U);
  EXPECT_TRUE(there->heights_only);
  EXPECT_FALSE(decode_options(encode_options(options).substr(1)));
}

TEST(ImportWireTest, ProgressIsReported) {
  tin::base::Progress progress;
  ImportReceiver receiver({}, &progress);
  EXPECT_TRUE(receiver.take(sent([](const Sink& sink) { return send_progress(0.5, sink); })));
  EXPECT_EQ(progress.fraction(), 0.5);
  EXPECT_FALSE(receiver.take(sent([](const Sink& sink) { return send_progress(1.5, sink); })));
}

TEST(ImportWireTest, NothingBeyondTheLimitsIsTaken) {
  const std::string bytes = sent_import(sample());
  EXPECT_TRUE(received(bytes, limits(6, 6)));
  EXPECT_FALSE(received(bytes, limits(5, 6)));
  EXPECT_FALSE(received(bytes, limits(6, 5)));
}

TEST(ImportWireTest, WhatIsNoTerrainIsRefused) {
  const auto with = [](const std::function<void(Import&, SourceGrid&)>& change) {
    Import import = sample();
    change(import, *import.grid);
    return received(sent_import(import)).ok();
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(with([](Import&, SourceGrid&) {}));
  EXPECT_FALSE(with([](Import& i, SourceGrid&) { i.placements[2].z = kNan; }));
  EXPECT_FALSE(with([](Import& i, SourceGrid&) { i.placements[2].at.x = tin::exact::kLatticeHalf; }));
  EXPECT_FALSE(with([](Import& i, SourceGrid&) { i.frame.x.parts = 0; }));
  EXPECT_FALSE(with([](Import& i, SourceGrid&) { i.frame.y.unit = -1; }));
  EXPECT_FALSE(with([](Import& i, SourceGrid&) { i.frame.vertical_unit_m = 0; }));
  EXPECT_FALSE(with([](Import&, SourceGrid& g) { g.width = -3; }));
  EXPECT_FALSE(with([](Import&, SourceGrid& g) { g.dx = 0; }));
  EXPECT_FALSE(with([](Import&, SourceGrid& g) { g.dx = 1 << 29; }));
  EXPECT_FALSE(with([](Import&, SourceGrid& g) { g.geotransform[3] = kNan; }));
  EXPECT_FALSE(with([](Import&, SourceGrid& g) { g.valid.push_back(0); }));
  EXPECT_FALSE(with([](Import& i, SourceGrid&) { i.heights.stored = tin::base::Array<std::int16_t>(7); }));
  EXPECT_FALSE(with([](Import& i, SourceGrid&) { i.heights.shift = 1000; }));
  const auto doubles = [&](double last) {
    return with([last](Import& i, SourceGrid& g) {
      g.valid = {0b011111};
      i.heights.stored = tin::base::Array<double>{1, 2, 3, 4, last, kNan};
    });
  };
  EXPECT_TRUE(doubles(5)) << "the last pixel is no sample";
  EXPECT_FALSE(doubles(kNan));
}

TEST(ImportWireTest, DamagedBytesNeverGetPastTheLimits) {
  const std::string good = sent_import(sample());
  std::mt19937_64 random(20021128);
  for (int round = 0; round < 20'000; ++round) {
    std::string bad = good;
    for (int flips = 0; flips < 3; ++flips) bad[random() % bad.size()] = static_cast<char>(random());
    if (round % 4 == 0) bad.resize(random() % bad.size());
    const auto import = received(bad);
    if (!import) continue;
    EXPECT_LE(import->placements.size(), 6U);
    for (const auto& placement : import->placements)
      EXPECT_TRUE(tin::exact::in_lattice(placement.at.x, placement.at.y));
  }
}

}  // namespace
}  // namespace server::gdal::testing
