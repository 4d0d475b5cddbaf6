#include "proto/formats/png.h"

#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <vector>

namespace {

using proto::formats::mapbox_colour;
using proto::formats::terrarium_colour;

double from_terrarium(std::array<std::uint8_t, 3> c) {
  return c[0] * 256.0 + c[1] + c[2] / 256.0 - 32768;
}
double from_mapbox(std::array<std::uint8_t, 3> c) {
  return -10000 + (c[0] * 65536.0 + c[1] * 256.0 + c[2]) * 0.1;
}

TEST(ColoursTest, GiveTheElevationBackWithinTheirRounding) {
  for (double h = -11000; h < 9000; h += 0.377) {
    EXPECT_NEAR(from_terrarium(terrarium_colour(h)), h, 1.0 / 512 + 1e-9);
    if (h >= -10000) {
      EXPECT_NEAR(from_mapbox(mapbox_colour(h)), h, 0.05 + 1e-9);
    }
  }
  EXPECT_EQ(terrarium_colour(0), (std::array<std::uint8_t, 3>{128, 0, 0}));
  EXPECT_EQ(mapbox_colour(0), (std::array<std::uint8_t, 3>{1, 134, 160}));
  EXPECT_EQ(terrarium_colour(255.9999), terrarium_colour(256)) << "rounded first, then split";
  EXPECT_EQ(mapbox_colour(-20000), (std::array<std::uint8_t, 3>{0, 0, 0}));
  EXPECT_EQ(terrarium_colour(1e30), (std::array<std::uint8_t, 3>{255, 255, 255}));
}

TEST(PngTest, LibpngReadsThePixelsBack) {
  for (const auto& [colours, format] : {std::pair{proto::formats::PngColours::kRgb, PNG_FORMAT_RGB},
                                        std::pair{proto::formats::PngColours::kGreyAlpha, PNG_FORMAT_GA}}) {
    std::vector<std::uint8_t> pixels(31 * 17 * static_cast<std::size_t>(colours));
    for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(i * 37 % 251);
    const std::string file = proto::formats::encode_png(31, 17, colours, pixels);
    EXPECT_EQ(file, proto::formats::encode_png(31, 17, colours, pixels));
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    ASSERT_TRUE(png_image_begin_read_from_memory(&image, file.data(), file.size()));
    EXPECT_EQ(image.width, 31U);
    EXPECT_EQ(image.height, 17U);
    image.format = static_cast<png_uint_32>(format);
    std::vector<std::uint8_t> read(PNG_IMAGE_SIZE(image));
    ASSERT_TRUE(png_image_finish_read(&image, nullptr, read.data(), 0, nullptr));
    EXPECT_EQ(read, pixels);
  }
}

}  // namespace
