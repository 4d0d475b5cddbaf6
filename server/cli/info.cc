#include "server/cli/info.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <optional>

#include "proto/json_write.h"
#include "server/cli/terminal.h"
#include "server/gdal/import.h"

namespace server::cli {

namespace {

struct Range {
  double min = std::numeric_limits<double>::infinity(), max = -min;
  void take(double value) {
    min = std::min(min, value);
    max = std::max(max, value);
  }
};

struct Facts {
  std::size_t samples = 0;
  Range x, y, z;  // x and y: of the samples' positions
};

Facts facts_of(const gdal::Import& import) {
  Facts facts;
  const auto take = [&](tin::exact::Point at, double z) {
    ++facts.samples;
    facts.x.take(import.frame.x.world(at.x));
    facts.y.take(import.frame.y.world(at.y));
    facts.z.take(z);
  };
  for (const auto& point : import.placements) take(point.at, point.z);
  if (!import.grid) return facts;
  const auto& grid = *import.grid;
  std::size_t pixel = 0;
  for (std::int32_t row = 0; row < grid.height; ++row) {
    for (std::int32_t column = 0; column < grid.width; ++column, ++pixel) {
      if (grid.is_valid(column, row)) take(grid.centre(column, row), import.heights.at(pixel));
    }
  }
  return facts;
}

void print_json(const InfoArguments& arguments, const gdal::Import& import, const Facts& facts) {
  proto::JsonWriter json;
  const auto range = [&](const char* name, const Range& r) {
    json.key(name).begin_array().number(r.min).number(r.max).end_array();
  };
  json.begin_object();
  json.key("file").string(arguments.file);
  json.key("format").string(import.driver);
  json.key("kind").string(import.grid ? "raster" : "points");
  json.key("crs");
  if (import.frame.crs.empty()) {
    json.null();
  } else {
    json.string(import.frame.crs);
  }
  if (import.grid) {
    const auto& grid = *import.grid;
    json.key("width").integer(static_cast<std::uint64_t>(grid.width));
    json.key("height").integer(static_cast<std::uint64_t>(grid.height));
    json.key("bands").integer(static_cast<std::uint64_t>(import.bands));
    json.key("dataType").string(grid.data_type);
    json.key("geotransform").begin_array();
    for (const double value : grid.geotransform) json.number(value);
    json.end_array();
    json.key("nodata");
    if (grid.nodata) {
      json.number(*grid.nodata);
    } else {
      json.null();
    }
  }
  json.key("samples").integer(facts.samples);
  range("xRange", facts.x);
  range("yRange", facts.y);
  range("zRange", facts.z);
  json.key("verticalUnit");
  if (import.frame.vertical_unit.empty()) {
    json.null();
  } else {
    json.string(import.frame.vertical_unit);
  }
  json.end_object();
  std::printf("%s\n", json.take().c_str());
}

void print_text(const InfoArguments& arguments, const gdal::Import& import, const Facts& facts) {
  std::printf("File: %s\nFormat: %s, %s\n", arguments.file.c_str(), import.driver.c_str(),
              import.grid ? "a raster" : "points");
  std::printf("CRS: %s\n", import.frame.crs.empty() ? "not said" : import.frame.crs.c_str());
  if (import.grid) {
    const auto& grid = *import.grid;
    const auto& gt = grid.geotransform;
    std::printf("Size: %d x %d pixels of type %s\n", grid.width, grid.height, grid.data_type.c_str());
    if (import.bands > 1) std::printf("Bands: %d, of which the first is read\n", import.bands);
    std::printf("Origin: %.15g, %.15g\nPixel size: %.15g, %.15g\n", gt[0], gt[3], gt[1], gt[5]);
    if (grid.nodata) {
      std::printf("Nodata: %.15g\n", *grid.nodata);
    } else {
      std::printf("Nodata: none\n");
    }
  }
  std::printf("Samples: %zu\n", facts.samples);
  std::printf("x: %.15g to %.15g\ny: %.15g to %.15g\n", facts.x.min, facts.x.max, facts.y.min, facts.y.max);
  const std::string& unit = import.frame.vertical_unit;
  std::printf("z: %.15g to %.15g %s\n", facts.z.min, facts.z.max,
              unit.empty() ? "in a unit that is not said" : unit.c_str());
}

}  // namespace

int info(const InfoArguments& arguments) {
  gdal::ImportOptions options = import_options(arguments.file, arguments.content);
  options.heights_only = true;
  const auto import = gdal::import_file(arguments.file, options, nullptr);
  if (!import) return fail(arguments.file, import.error());
  const Facts facts = facts_of(*import);
  if (arguments.json) {
    print_json(arguments, *import, facts);
  } else {
    print_text(arguments, *import, facts);
  }
  return 0;
}

}  // namespace server::cli
