#include "proto/formats/png.h"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <vector>

#include "tin/base/check.h"

namespace proto::formats {
namespace {

/// What libpng calls with each piece of the file.
void append(png_structp png, png_bytep data, png_size_t size) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), size);
}
void flush_nothing(png_structp) {}

/// libpng ends by longjmp where it fails, which would pass by destructors: everything with one is made before.
bool write(png_structp png, png_infop info, std::uint32_t width, std::uint32_t height, int type, png_bytepp rows) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_IHDR(png, info, width, height, 8, type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  // Elevations are smooth: a quick filter and a quick level give nine tenths of what slow ones do.
  png_set_compression_level(png, 2);
  png_set_filter(png, 0, PNG_FILTER_UP);
  png_set_rows(png, info, rows);
  png_write_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
  return true;
}

std::array<std::uint8_t, 3> split(double value) {
  const auto whole = static_cast<std::uint32_t>(std::clamp(std::round(value), 0.0, 16777215.0));
  return {static_cast<std::uint8_t>(whole >> 16), static_cast<std::uint8_t>(whole >> 8 & 255),
          static_cast<std::uint8_t>(whole & 255)};
}

}  // namespace

std::string encode_png(std::uint32_t width, std::uint32_t height, PngColours colours, std::span<const std::uint8_t> pixels) {
  const std::size_t row_bytes = std::size_t{width} * static_cast<std::size_t>(colours);
  TIN_CHECK(pixels.size() == row_bytes * height);
  std::string out;
  std::vector<png_bytep> rows;
  for (std::uint32_t row = 0; row < height; ++row) {
    rows.push_back(const_cast<png_bytep>(pixels.data() + row * row_bytes));  // libpng only reads them
  }
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  if (png == nullptr) throw std::bad_alloc();
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(png, &out, append, flush_nothing);
  const int type = colours == PngColours::kRgb ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY_ALPHA;
  const bool written = info != nullptr && write(png, info, width, height, type, rows.data());
  png_destroy_write_struct(&png, &info);
  if (!written) throw std::bad_alloc();  // nothing else can fail: the picture is ours
  return out;
}

std::array<std::uint8_t, 3> terrarium_colour(double height_m) {
  return split((height_m + 32768) * 256);
}

std::array<std::uint8_t, 3> mapbox_colour(double height_m) {
  return split((height_m + 10000) * 10);
}

}  // namespace proto::formats
