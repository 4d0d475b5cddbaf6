#include "server/gdal/ascii_grid.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>

#include "tests/server/gdal/support.h"

namespace server::gdal::testing {
namespace {

using tin::base::Code;
using tin::base::Result;

class AsciiGridTest : public ScratchTest {
 protected:
  std::string text() const {
    std::ifstream in(path("out.asc"), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static RasterSpec spec(std::int64_t width, std::int64_t height) {
    RasterSpec spec;
    spec.width = width;
    spec.height = height;
    spec.geotransform = {500000.25, 10, 0, 5000000.125, 0, -10};
    return spec;
  }
};

TEST_F(AsciiGridTest, ASmallOneAsItMustBe) {
  const auto rows = [](std::int64_t row, std::span<double> values) -> Result<void> {
    values[0] = 12;
    values[1] = row == 0 ? 0.1F : -9999;
    return {};
  };
  ASSERT_TRUE(write_ascii_grid(path("out.asc"), spec(2, 2), rows).ok());
  EXPECT_EQ(text(),
            "ncols 2\nnrows 2\nxllcorner 500000.25\nyllcorner 4999980.125\ncellsize 10\nNODATA_value -9999\n"
            "12.0 0.1\n12 -9999\n");
}

TEST_F(AsciiGridTest, GdalReadsEveryValueBack) {
  for (const char* type : {"Float32", "Float64"}) {
    RasterSpec wanted = spec(100, 80);
    wanted.data_type = type;
    wanted.geotransform = {7.1, 1.0 / 1200, 0, 46, 0, -1.0 / 600};  // pixels that are not square
    const auto value = [type](std::int64_t row, std::size_t column) {
      const double exact = std::exp(static_cast<double>(column) / 7) / static_cast<double>(row + 3);
      return type == std::string("Float32") ? static_cast<double>(static_cast<float>(exact)) : exact;
    };
    const auto rows = [&value](std::int64_t row, std::span<double> values) -> Result<void> {
      for (std::size_t i = 0; i < values.size(); ++i) values[i] = value(row, i);
      return {};
    };
    ASSERT_TRUE(write_ascii_grid(path("out.asc"), wanted, rows).ok());
    const ReadBack read = read_back(path("out.asc"));
    EXPECT_EQ(read.width, 100);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(read.geotransform[i], wanted.geotransform[i], 1e-12);
    EXPECT_EQ(read.nodata, -9999);
    // GDAL takes the values of this format as Float32, whatever they are; the text holds more.
    std::istringstream body(text());
    std::string skipped;
    for (int line = 0; line < 7; ++line) std::getline(body, skipped);
    for (std::int64_t row = 0; row < 80; ++row) {
      for (std::size_t column = 0; column < 100; ++column) {
        double in_text = 0;
        body >> in_text;
        const double wanted_value = value(row, column);
        ASSERT_EQ(type == std::string("Float32") ? static_cast<double>(static_cast<float>(in_text)) : in_text,
                  wanted_value);
        ASSERT_EQ(static_cast<float>(read.values[static_cast<std::size_t>(row) * 100 + column]),
                  static_cast<float>(wanted_value));
      }
    }
  }
}

TEST_F(AsciiGridTest, WhatItCannotSayIsRefusedAndLeavesNoFile) {
  RasterSpec wanted = spec(2, 2);
  wanted.geotransform[5] = 10;
  const auto fine = [](std::int64_t, std::span<double>) { return Result<void>(); };
  EXPECT_EQ(write_ascii_grid(path("out.asc"), wanted, fine).error().code, Code::kInvalidValue);
  const auto failing = [](std::int64_t row, std::span<double>) -> Result<void> {
    if (row == 0) return {};
    return tin::base::error(Code::kCancelled, "enough");
  };
  EXPECT_EQ(write_ascii_grid(path("out.asc"), spec(2, 2), failing).error().code, Code::kCancelled);
  EXPECT_EQ(write_ascii_grid(path("none/out.asc"), spec(2, 2), fine).error().code, Code::kStorage);
  EXPECT_EQ(files_left(), 0U);
}

}  // namespace
}  // namespace server::gdal::testing
