#include "server/tiles/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "proto/formats/png.h"
#include "server/tiles/sampler.h"

namespace server::tiles {

using proto::formats::PngColours;
using tin::base::Result;

namespace {

constexpr std::size_t kSide = kPicturePixels;
/// One more pixel on each side, for slopes.
constexpr std::size_t kWide = kSide + 2;

std::string elevations(const std::vector<double>& heights, PictureKind kind) {
  std::vector<std::uint8_t> pixels;
  pixels.reserve(kSide * kSide * 3);
  for (const double height : heights) {
    const double h = std::isnan(height) ? 0 : height;
    const auto colour = kind == PictureKind::kTerrarium ? proto::formats::terrarium_colour(h) : proto::formats::mapbox_colour(h);
    pixels.insert(pixels.end(), colour.begin(), colour.end());
  }
  return proto::formats::encode_png(kSide, kSide, PngColours::kRgb, pixels);
}

/// Brightness from 1 to 255 under a sun in the north-west, 45 degrees high; slopes by Horn's weights (1981).
std::uint8_t shade(const std::array<double, 9>& z, double pixel_m) {
  const double east = (z[2] + 2 * z[5] + z[8] - z[0] - 2 * z[3] - z[6]) / (8 * pixel_m);
  const double north = (z[0] + 2 * z[1] + z[2] - z[6] - 2 * z[7] - z[8]) / (8 * pixel_m);
  // The normal (-east, -north, 1) against the direction of the sun (-1/2, 1/2, 1/sqrt 2).
  const double lit = (0.5 * east - 0.5 * north + std::numbers::sqrt2 / 2) / std::sqrt(1 + east * east + north * north);
  return static_cast<std::uint8_t>(std::lround(1 + 254 * std::max(0.0, lit)));
}

std::string relief(const std::vector<double>& heights, double pixel_m) {
  std::vector<std::uint8_t> pixels;
  pixels.reserve(kSide * kSide * 2);
  for (std::size_t row = 1; row <= kSide; ++row) {
    for (std::size_t column = 1; column <= kSide; ++column) {
      const double* at = heights.data() + row * kWide + column;
      if (std::isnan(*at)) {
        pixels.insert(pixels.end(), {0, 0});
        continue;
      }
      std::array<double, 9> z{};
      for (int i = 0; i < 9; ++i) {
        const double there = at[(i / 3 - 1) * static_cast<int>(kWide) + i % 3 - 1];
        z[static_cast<std::size_t>(i)] = std::isnan(there) ? *at : there;  // beyond the rim it is as high as here
      }
      pixels.insert(pixels.end(), {shade(z, pixel_m), 255});
    }
  }
  return proto::formats::encode_png(kSide, kSide, PngColours::kGreyAlpha, pixels);
}

}  // namespace

Result<std::string> picture_tile(const tin::terrain::Terrain& terrain, PictureKind kind, const TileId& id) {
  auto sampler = Sampler::create(terrain, "EPSG:3857");
  if (!sampler) return sampler.error();
  const MercatorSquare square = mercator_square(id);
  const double pixel = (square.east - square.west) / kPicturePixels;
  const int border = kind == PictureKind::kHillshade ? 1 : 0, count = kPicturePixels + 2 * border;
  const std::vector<double> heights = sampler->heights(
      {square.west + pixel * (0.5 - border), pixel, count, square.north - pixel * (0.5 - border), -pixel, count});
  if (kind != PictureKind::kHillshade) return elevations(heights, kind);
  // A metre of web mercator is shorter on the ground away from the equator.
  const double middle = (square.south + square.north) / 2;
  return relief(heights, pixel / std::cosh(middle / 6378137.0));
}

}  // namespace server::tiles
