// Which format an upload has: by its content first, helped by what the client says of it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "tin/base/result.h"

namespace server::gdal {

struct ImportOptions;

enum class Format {
  kGeoTiff,
  kHgt,
  kAsciiGrid,
  kUsgsDem,
  kDted,
  kDelimited,  // CSV, XYZ: numbers in columns
  kGeoJson,
  kGeoPackage,
  kFlatGeobuf,
  kObj,
  kPly,
  kSms2dm,
  kLandXml,
  kLas,
  kShapefile,
  kZippedShapefile,
  kSurferText,
  kSurferBinary,
  kSurfer7,
  kVtpTerrain,
};

/// A format, and the name under which its file is shown to GDAL.
struct Recognised {
  Format format;
  std::string file_name;
};

/// Recognises the upload from its first bytes and its size; the client's `format`, `content_type` and
/// `file_name` decide where the content does not, and must not contradict it. Errors: kInvalidValue for an
/// empty file and for an HGT without its name; kUnsupported for what we do not read.
tin::base::Result<Recognised> recognise(const std::filesystem::path& uploaded, const ImportOptions& options);

/// "GeoTIFF", "CSV or XYZ points" ...: as messages call it.
std::string_view format_title(Format format);

}  // namespace server::gdal
