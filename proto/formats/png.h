// PNG pictures, and elevations as the colours that MapLibre and others read.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace proto::formats {

inline constexpr std::string_view kPngMediaType = "image/png";

enum class PngColours : std::uint8_t { kGreyAlpha = 2, kRgb = 3 };  // the number is that of bytes a pixel

/// The file's bytes, equal for equal pixels. Requires: width * height * bytes a pixel.
std::string encode_png(std::uint32_t width, std::uint32_t height, PngColours colours, std::span<const std::uint8_t> pixels);

/// Elevation as colour: h = R * 256 + G + B / 256 - 32768, to the nearest 1/256 m; beyond -32768 m and 32767.996 m the nearest.
std::array<std::uint8_t, 3> terrarium_colour(double height_m);

/// Elevation as colour: h = -10000 + (R * 65536 + G * 256 + B) / 10, to the nearest 0.1 m.
std::array<std::uint8_t, 3> mapbox_colour(double height_m);

}  // namespace proto::formats
