#include "tests/tin/simplify/terrains.h"

#include <cmath>
#include <cstdio>
#include <memory>

namespace support {

using tin::exact::Point;
using tin::terrain::Duplicates;
using tin::terrain::Placement;
using tin::terrain::SourceGrid;
using tin::terrain::Terrain;

Heights heights(std::int32_t width, std::int32_t height,
                const std::function<std::optional<double>(std::int32_t, std::int32_t)>& z) {
  Heights out{width, height, {}};
  for (std::int32_t row = 0; row < height; ++row) {
    for (std::int32_t column = 0; column < width; ++column) out.z.push_back(z(column, row));
  }
  return out;
}

Terrain raster_terrain(const Heights& raster, std::int32_t dx, std::int32_t dy) {
  auto grid = std::make_shared<SourceGrid>();
  grid->width = raster.width;
  grid->height = raster.height;
  grid->x0 = -dx * (raster.width / 2);
  grid->y0 = dy * (raster.height / 2);
  grid->dx = dx;
  grid->dy = -dy;
  std::vector<Placement> placements;
  for (std::size_t i = 0; i < raster.z.size(); ++i) {
    const auto width = static_cast<std::size_t>(raster.width);
    const auto column = static_cast<std::int32_t>(i % width), row = static_cast<std::int32_t>(i / width);
    if (raster.z[i]) placements.push_back({grid->centre(column, row), *raster.z[i]});
  }
  auto terrain = Terrain::build({}, placements, Duplicates::kReject);
  terrain->set_source_grid(std::move(grid));
  return std::move(terrain).value();
}

std::vector<NamedHeights> hard_rasters(Random& random, std::int32_t size) {
  const auto noise = [&](int most) {
    return static_cast<double>(random() % static_cast<unsigned>(most + 1));
  };
  const auto wave = [&](std::int32_t c, std::int32_t r) {
    return 40 * std::sin(c * 0.31) * std::cos(r * 0.17) + noise(3);
  };
  const std::int32_t w = size, h = size * 3 / 4 + 2;
  std::vector<NamedHeights> out;
  const auto add = [&](const char* name, std::int32_t width, std::int32_t height, auto z) {
    out.push_back({name, heights(width, height, z)});
  };
  add("noise", w, h, [&](auto, auto) { return std::optional(noise(20)); });
  add("plateaus", w, h, [&](auto c, auto r) { return std::optional(std::floor(wave(c, r) / 20) * 20); });
  add("spikes", w, h, [&](auto, auto) { return std::optional(noise(30) == 0 ? 100.0 : 5.0); });
  add("ridges", w, h,
      [&](auto c, auto r) { return std::optional(c == w / 3 || r == h / 2 || c == r ? 50.0 : 0.0); });
  add("slope", w, h, [&](auto c, auto r) { return std::optional(3.0 * c - 2.0 * r); });
  add("voids", w, h, [&](auto c, auto r) {
    return noise(4) == 0 || (c > w / 2 && r < h / 3) ? std::nullopt : std::optional(std::round(wave(c, r)));
  });
  add("round void", w, h, [&](auto c, auto r) {
    const double x = c - w / 2.0, y = r - h / 2.0;
    return x * x + y * y > w * h / 5.0 ? std::nullopt : std::optional(std::round(wave(c, r)));
  });
  add("quarters", w, h, [&](auto c, auto r) { return std::optional(std::round(wave(c, r) * 4) / 4); });
  add("tenths", w, h, [&](auto c, auto r) { return std::optional(std::round(wave(c, r) * 10) / 10); });
  add("reals with voids", w, h,
      [&](auto c, auto r) { return noise(9) == 0 ? std::nullopt : std::optional(wave(c, r) / 3 - 1e3); });
  add("tilted reals", w, h, [&](auto c, auto r) { return std::optional(0.1 * c + 0.7 * r); });
  add("huge", w, h, [&](auto c, auto r) { return std::optional(wave(c, r) * 0x1p+80); });
  add("constant", w, h, [&](auto, auto) { return std::optional(12.0); });
  add("constant tenth", w, h, [&](auto, auto) { return std::optional(0.1); });
  add("2 x 2", 2, 2, [&](auto, auto) { return std::optional(noise(9)); });
  add("2 rows", w, 2, [&](auto, auto) { return std::optional(noise(9)); });
  return out;
}

Terrain scattered_terrain(Random& random, std::size_t count, std::int32_t extent, bool whole_heights) {
  std::vector<Placement> placements;
  for (const Point p : random_points(random, count, extent)) {
    const double x = static_cast<double>(p.x) / extent, y = static_cast<double>(p.y) / extent;
    const double z = 50 * std::sin(5 * x) * std::cos(4 * y) + static_cast<double>(random() % 100) / 30;
    placements.push_back({p, whole_heights ? std::round(z) : z});
  }
  return std::move(Terrain::build({}, placements, Duplicates::kKeep)).value();
}

std::optional<Terrain> hgt_terrain(const std::string& path, double south_latitude, std::int32_t crop) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) return std::nullopt;
  constexpr std::int32_t kSide = 1201;
  std::vector<unsigned char> bytes(std::size_t{2} * kSide * kSide);
  if (std::fread(bytes.data(), 1, bytes.size(), file.get()) != bytes.size()) return std::nullopt;
  const std::int32_t side = crop == 0 ? kSide : crop;
  const auto z = [&](std::int32_t column, std::int32_t row) -> std::optional<double> {
    const std::size_t i = 2 * (static_cast<std::size_t>(row) * kSide + static_cast<std::size_t>(column));
    const auto value = static_cast<std::int16_t>(bytes[i] << 8 | bytes[i + 1]);
    return value == -32768 ? std::nullopt : std::optional<double>(value);
  };
  const double pixel = 1.0 / 1200;
  const auto frame =
      tin::frame::fit_raster({0, south_latitude + 1, pixel, pixel, kSide, kSide}, {.geographic = true});
  return raster_terrain(heights(side, side, z), static_cast<std::int32_t>(frame->x.parts),
                        static_cast<std::int32_t>(frame->y.parts));
}

}  // namespace support
