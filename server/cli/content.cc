#include "server/cli/content.h"

#include "tin/codec/checkpoint.h"

namespace server::cli {

gdal::ImportOptions import_options(const std::filesystem::path& file, const ContentArguments& content) {
  gdal::ImportOptions options;
  options.file_name = file.filename();
  options.crs = content.crs;
  options.format = content.format;
  options.layer = content.layer;
  options.z_field = content.z_field;
  for (const unsigned one : content.classes) options.classes.push_back(static_cast<std::uint8_t>(one));
  options.max_pixels = options.max_samples = tin::codec::kMaxGridPixels;
  return options;
}

}  // namespace server::cli
