#include "server/gdal/format.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <fstream>
#include <optional>
#include <regex>
#include <system_error>

#include "server/gdal/import.h"

namespace server::gdal {
namespace {

using tin::base::Code;
using tin::base::error;
using tin::base::Result;

constexpr std::size_t kHeadBytes = 4096;

struct FormatTraits {
  Format format;
  std::string_view title, file_name;
};
constexpr std::array kTraits{
    FormatTraits{Format::kGeoTiff, "GeoTIFF", "raster.tif"},
    FormatTraits{Format::kHgt, "SRTM HGT", ""},
    FormatTraits{Format::kAsciiGrid, "Arc/Info ASCII grid", "raster.asc"},
    FormatTraits{Format::kUsgsDem, "USGS DEM", "raster.dem"},
    FormatTraits{Format::kDted, "DTED", "raster.dt2"},
    FormatTraits{Format::kDelimited, "CSV or XYZ points", "points.csv"},
    FormatTraits{Format::kGeoJson, "GeoJSON", "points.geojson"},
    FormatTraits{Format::kGeoPackage, "GeoPackage", "points.gpkg"},
    FormatTraits{Format::kFlatGeobuf, "FlatGeobuf", "points.fgb"},
    FormatTraits{Format::kObj, "Wavefront OBJ", "mesh.obj"},
    FormatTraits{Format::kPly, "PLY", "mesh.ply"},
    FormatTraits{Format::kSms2dm, "2DM", "mesh.2dm"},
    FormatTraits{Format::kLandXml, "LandXML", "surface.xml"},
    FormatTraits{Format::kLas, "LAS", "points.las"},
    FormatTraits{Format::kShapefile, "Shapefile", "points.shp"},
    FormatTraits{Format::kZippedShapefile, "zipped Shapefile", "upload.zip"},
    FormatTraits{Format::kSurferText, "Surfer text grid", "raster.grd"},
    FormatTraits{Format::kSurferBinary, "Surfer 6 grid", "raster.grd"},
    FormatTraits{Format::kSurfer7, "Surfer 7 grid", "raster.grd"},
    FormatTraits{Format::kVtpTerrain, "VTP Binary Terrain", "raster.bt"},
};
const FormatTraits& traits(Format format) {
  return *std::find_if(kTraits.begin(), kTraits.end(), [&](const auto& t) { return t.format == format; });
}

/// Names of formats, file extensions and media types that clients use.
struct Alias {
  std::string_view name;
  Format format;
};
constexpr std::array kAliases{
    Alias{"geotiff", Format::kGeoTiff},
    Alias{"gtiff", Format::kGeoTiff},
    Alias{"tif", Format::kGeoTiff},
    Alias{"tiff", Format::kGeoTiff},
    Alias{"cog", Format::kGeoTiff},
    Alias{"image/tiff", Format::kGeoTiff},
    Alias{"image/geotiff", Format::kGeoTiff},
    Alias{"hgt", Format::kHgt},
    Alias{"srtmhgt", Format::kHgt},
    Alias{"aaigrid", Format::kAsciiGrid},
    Alias{"asc", Format::kAsciiGrid},
    Alias{"usgsdem", Format::kUsgsDem},
    Alias{"dem", Format::kUsgsDem},
    Alias{"dted", Format::kDted},
    Alias{"dt0", Format::kDted},
    Alias{"dt1", Format::kDted},
    Alias{"dt2", Format::kDted},
    Alias{"csv", Format::kDelimited},
    Alias{"tsv", Format::kDelimited},
    Alias{"xyz", Format::kDelimited},
    Alias{"text/csv", Format::kDelimited},
    Alias{"text/tab-separated-values", Format::kDelimited},
    Alias{"geojson", Format::kGeoJson},
    Alias{"application/geo+json", Format::kGeoJson},
    Alias{"application/vnd.geo+json", Format::kGeoJson},
    Alias{"gpkg", Format::kGeoPackage},
    Alias{"geopackage", Format::kGeoPackage},
    Alias{"application/geopackage+sqlite3", Format::kGeoPackage},
    Alias{"fgb", Format::kFlatGeobuf},
    Alias{"flatgeobuf", Format::kFlatGeobuf},
    Alias{"application/flatgeobuf", Format::kFlatGeobuf},
    Alias{"obj", Format::kObj},
    Alias{"model/obj", Format::kObj},
    Alias{"ply", Format::kPly},
    Alias{"application/ply", Format::kPly},
    Alias{"2dm", Format::kSms2dm},
    Alias{"landxml", Format::kLandXml},
    Alias{"xml", Format::kLandXml},
    Alias{"application/xml", Format::kLandXml},
    Alias{"las", Format::kLas},
    Alias{"laz", Format::kLas},
    Alias{"application/vnd.las", Format::kLas},
    Alias{"application/vnd.laszip", Format::kLas},
    Alias{"shp", Format::kShapefile},
    Alias{"application/vnd.shp", Format::kShapefile},
    Alias{"zip", Format::kZippedShapefile},
    Alias{"application/zip", Format::kZippedShapefile},
    Alias{"application/vnd.shp+zip", Format::kZippedShapefile},
    Alias{"gsag", Format::kSurferText},
    Alias{"gsbg", Format::kSurferBinary},
    Alias{"gs7bg", Format::kSurfer7},
    Alias{"bt", Format::kVtpTerrain},
};

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::tolower(c); });
  return out;
}

std::optional<Format> named(std::string_view name) {
  const std::string wanted = lower(name);
  for (const Alias& alias : kAliases) {
    if (alias.name == wanted) return alias.format;
  }
  return std::nullopt;
}

/// What the client says without insisting: its media type, else the extension of its file name.
std::optional<Format> suggested(const ImportOptions& options) {
  std::string_view type = options.content_type;
  type = type.substr(0, type.find(';'));
  while (!type.empty() && type.back() == ' ') type.remove_suffix(1);
  if (const auto format = named(type); format && type.find('/') != std::string_view::npos) return format;
  const std::size_t dot = options.file_name.rfind('.');
  return dot == std::string::npos ? std::nullopt : named(std::string_view(options.file_name).substr(dot + 1));
}

struct Content {
  std::string head;
  std::uint64_t bytes = 0;

  bool starts_with(std::string_view magic) const { return head.compare(0, magic.size(), magic) == 0; }
  bool is_text() const {
    return std::none_of(head.begin(), head.end(), [](char c) {
      const auto byte = static_cast<unsigned char>(c);
      return byte < 0x20 && byte != '\t' && byte != '\n' && byte != '\r' && byte != '\f';
    });
  }
};

Result<Content> look_at(const std::filesystem::path& file) {
  std::error_code problem;
  Content content;
  content.bytes = std::filesystem::file_size(file, problem);
  std::ifstream in(file, std::ios::binary);
  if (std::filesystem::is_directory(file)) return error(Code::kInvalidValue, "It is a folder, not a file");
  if (problem || !in) return error(Code::kInvalidValue, "There is no such file, or it cannot be read");
  content.head.resize(kHeadBytes);
  in.read(content.head.data(), kHeadBytes);
  content.head.resize(static_cast<std::size_t>(in.gcount()));
  if (content.head.empty()) return error(Code::kInvalidValue, "The file is empty");
  return content;
}

bool is_tiff(const Content& content) {
  constexpr std::array<std::string_view, 4> kMagic{{{"II*\0", 4}, {"MM\0*", 4}, {"II+\0", 4}, {"MM\0+", 4}}};
  return std::any_of(kMagic.begin(), kMagic.end(), [&](auto magic) { return content.starts_with(magic); });
}

bool is_hgt_size(std::uint64_t bytes) {
  return bytes == 2884802 || bytes == 25934402 || bytes == 12970802;
}

/// Header keywords of an ASCII grid come first, in any case of letters.
bool is_ascii_grid(const std::string& text) {
  return text.starts_with("ncols") || text.starts_with("nrows") || text.starts_with("xllc") ||
         text.starts_with("yllc") || text.starts_with("dx ") || text.starts_with("cellsize");
}

/// Record type A of a USGS DEM: level code and pattern code stand in columns 145 to 156.
bool is_usgs_dem(const Content& content) {
  if (content.head.size() < 1024) return false;
  const std::string_view pattern = std::string_view(content.head).substr(150, 6);
  const std::string_view system = std::string_view(content.head).substr(156, 6);
  const bool regular = pattern == "     1" || pattern == "     4";
  return regular && (system == "     0" || system == "     1" || system == "     2" || system == "     3" ||
                     system == " -9999");
}

/// The format that the content alone proves.
std::optional<Format> proven(const Content& content) {
  if (is_tiff(content)) return Format::kGeoTiff;
  if (content.starts_with({"SQLite format 3\0", 16})) return Format::kGeoPackage;
  if (content.starts_with("fgb\003fgb")) return Format::kFlatGeobuf;
  if (content.starts_with("UHL1") || content.starts_with("VOL1") || content.starts_with("HDR1"))
    return Format::kDted;
  if (content.starts_with("LASF")) return Format::kLas;
  if (content.starts_with({"\0\0\x27\x0a", 4})) return Format::kShapefile;
  if (content.starts_with("PK\x03\x04")) return Format::kZippedShapefile;
  if (content.starts_with("DSAA")) return Format::kSurferText;
  if (content.starts_with("DSBB")) return Format::kSurferBinary;
  if (content.starts_with("DSRB")) return Format::kSurfer7;
  if (content.starts_with("binterr1.")) return Format::kVtpTerrain;
  if (is_usgs_dem(content)) return Format::kUsgsDem;
  if (content.starts_with("ply\n") || content.starts_with("ply\r\n")) return Format::kPly;
  if (!content.is_text()) return is_hgt_size(content.bytes) ? std::optional(Format::kHgt) : std::nullopt;
  std::string text =
      lower(std::string_view(content.head).substr(content.starts_with("\xEF\xBB\xBF") ? 3 : 0));
  text.erase(0, text.find_first_not_of(" \t\r\n"));
  if (text.starts_with('{')) return Format::kGeoJson;
  if (text.starts_with('<') && text.find("landxml") != std::string::npos) return Format::kLandXml;
  if (text.starts_with("mesh2d")) return Format::kSms2dm;
  if (is_ascii_grid(text)) return Format::kAsciiGrid;
  return std::nullopt;
}

/// An HGT's position is in its name only: taken from the client's when that is exactly of the pattern.
Result<Recognised> hgt(const ImportOptions& options) {
  static const std::regex pattern(R"(([NS]\d\d[EW]\d\d\d)(\.SRTMGL1)?\.hgt)", std::regex::icase);
  std::smatch match;
  if (options.file_name.size() > 32 || !std::regex_match(options.file_name, match, pattern)) {
    return error(
        Code::kInvalidValue,
        "An HGT file tells its position by its name only: send it with a file name such as N44W072.hgt "
        "(for example as Content-Disposition: attachment; filename=\"N44W072.hgt\")");
  }
  std::string tile = match[1];
  std::transform(tile.begin(), tile.end(), tile.begin(), [](unsigned char c) { return std::toupper(c); });
  return Recognised{Format::kHgt, tile + ".hgt"};
}

/// "GeoTIFF, SRTM HGT ... or LandXML".
std::string all_titles() {
  std::string titles;
  for (const FormatTraits& one : kTraits) {
    if (&one != kTraits.data()) titles += &one == &kTraits.back() ? " or " : ", ";
    titles += one.title;
  }
  return titles;
}

/// Lines that begin with "v " come first, after comments and other keywords of OBJ.
bool is_obj(std::string_view text) {
  constexpr std::array<std::string_view, 8> kBefore{"#",  "mtllib ", "o ",  "g ",
                                                    "s ", "vt ",     "vn ", "usemtl "};
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    if (line.starts_with("v ") || line.starts_with("v\t")) return true;
    const bool blank = line.find_first_not_of(" \t\r") == std::string_view::npos;
    const bool before = std::any_of(kBefore.begin(), kBefore.end(),
                                    [line](std::string_view word) { return line.starts_with(word); });
    if (!blank && !before) return false;
    text.remove_prefix(std::min(line.size() + 1, text.size()));
  }
  return false;
}

tin::base::Error unrecognised(std::optional<Format> expected) {
  std::string message = "The file is not recognised as ";
  if (expected)
    message += "a " + std::string(format_title(*expected)) + " file";
  else
    message += all_titles();
  return error(Code::kUnsupported, std::move(message));
}

}  // namespace

std::string_view format_title(Format format) {
  return traits(format).title;
}

Result<Recognised> recognise(const std::filesystem::path& uploaded, const ImportOptions& options) {
  std::optional<Format> insisted;
  if (!options.format.empty()) {
    insisted = named(options.format);
    if (!insisted)
      return error(Code::kUnsupported, "There is no format of this name that we read", "query:format");
  }
  const auto content = look_at(uploaded);
  if (!content) return content.error();
  const std::optional<Format> expected = insisted ? insisted : suggested(options);
  std::optional<Format> found = proven(*content);
  if (!found) {
    const bool markup =
        content->is_text() && content->head.find_first_not_of(" \t\r\n") == content->head.find('<');
    const bool points = content->is_text() && !markup && (!expected || *expected == Format::kDelimited);
    if (content->is_text() && (expected ? *expected == Format::kObj : is_obj(content->head))) {
      found = Format::kObj;
    } else if (points) {
      found = Format::kDelimited;
    }
  }
  if (!found || (insisted && *insisted != *found)) return unrecognised(expected);
  if (*found == Format::kHgt) return hgt(options);
  return Recognised{*found, std::string(traits(*found).file_name)};
}

}  // namespace server::gdal
