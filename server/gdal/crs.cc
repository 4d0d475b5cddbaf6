#include "server/gdal/crs.h"

#include <ogr_spatialref.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <vector>

#include "server/gdal/crs_internal.h"
#include "server/gdal/library.h"

namespace server::gdal {
namespace {

using tin::base::Code;
using tin::base::error;
using tin::base::Error;
using tin::base::Result;

constexpr std::size_t kLongestWkt = 65536;
constexpr int kLon84 = 4326;

bool same_letters(std::string_view a, std::string_view b) {
  return a.size() == b.size() && EQUALN(a.data(), b.data(), b.size());
}

/// Removes `prefix`, in any case of letters, from the front of `text`.
bool take(std::string_view& text, std::string_view prefix) {
  if (text.size() < prefix.size() || !same_letters(text.substr(0, prefix.size()), prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

std::optional<int> code_number(std::string_view digits) {
  int code = 0;
  const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), code);
  if (problem != std::errc() || end != digits.data() + digits.size() || code <= 0) return std::nullopt;
  return code;
}

/// The EPSG code that one of the short forms names; nothing when `text` is none of them.
std::optional<int> epsg_of(std::string_view text) {
  for (const std::string_view name :
       {"OGC:CRS84", "CRS84", "CRS:84", "http://www.opengis.net/def/crs/OGC/1.3/CRS84",
        "https://www.opengis.net/def/crs/OGC/1.3/CRS84", "http://www.opengis.net/def/crs/OGC/0/CRS84",
        "urn:ogc:def:crs:OGC:1.3:CRS84", "urn:ogc:def:crs:OGC::CRS84"}) {
    if (same_letters(text, name)) return kLon84;
  }
  if (take(text, "EPSG:")) return code_number(text);
  char separator = '/';
  if (take(text, "urn:ogc:def:crs:EPSG:")) {
    separator = ':';
  } else if (!take(text, "http://www.opengis.net/def/crs/EPSG/") &&
             !take(text, "https://www.opengis.net/def/crs/EPSG/")) {
    return std::nullopt;
  }
  const std::size_t version_end = text.find(separator);
  if (version_end == std::string_view::npos) return std::nullopt;
  return code_number(text.substr(version_end + 1));
}

bool looks_like_wkt(std::string_view text) {
  const std::size_t bracket = text.find_first_of("[(");
  return bracket != std::string_view::npos && bracket > 3 && bracket < 24 &&
         std::all_of(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(bracket),
                     [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_'; });
}

bool same_crs(const OGRSpatialReference& a, const OGRSpatialReference& b) {
  const char* const options[] = {"IGNORE_DATA_AXIS_TO_SRS_AXIS_MAPPING=YES", nullptr};
  return a.IsSame(&b, options) != FALSE;
}

/// An EPSG code under which `crs` is known and which means the same.
std::optional<int> known_code(const OGRSpatialReference& crs) {
  const auto means_the_same = [&](int code) {
    OGRSpatialReference known;
    return known.importFromEPSG(code) == OGRERR_NONE && same_crs(known, crs);
  };
  const char* const authority = crs.GetAuthorityName(nullptr);
  const char* const own_code = crs.GetAuthorityCode(nullptr);
  if (authority != nullptr && own_code != nullptr) {
    if (EQUAL(authority, "OGC") && EQUAL(own_code, "CRS84")) return kLon84;
    const std::optional<int> code = EQUAL(authority, "EPSG") ? code_number(own_code) : std::nullopt;
    if (code && means_the_same(*code)) return code;
  }
  int count = 0;
  int* confidence = nullptr;
  OGRSpatialReferenceH* matches = crs.FindMatches(nullptr, &count, &confidence);
  std::optional<int> found;
  for (int i = 0; i < count && !found; ++i) {
    const auto* match = OGRSpatialReference::FromHandle(matches[i]);
    const char* const name = match->GetAuthorityName(nullptr);
    const char* const code = match->GetAuthorityCode(nullptr);
    if (name == nullptr || code == nullptr || !EQUAL(name, "EPSG")) continue;
    found = code_number(code);
    if (found && !means_the_same(*found)) found.reset();
  }
  OSRFreeSRSArray(matches);
  CPLFree(confidence);
  return found;
}

Result<std::string> canonical_name(const OGRSpatialReference& crs) {
  if (const auto code = known_code(crs)) return "EPSG:" + std::to_string(*code);
  char* text = nullptr;
  const char* const options[] = {"FORMAT=WKT2_2019", "MULTILINE=NO", nullptr};
  const OGRErr problem = crs.exportToWkt(&text, options);
  std::string wkt = text == nullptr ? "" : text;
  CPLFree(text);
  if (problem != OGRERR_NONE || wkt.empty()) {
    return error(Code::kUnsupported, "The coordinate reference system cannot be written as WKT", "crs");
  }
  return wkt;
}

std::optional<VerticalUnit> vertical_unit_of(const OGRSpatialReference& crs) {
  if (!crs.IsCompound() && crs.GetAxesCount() < 3) return std::nullopt;
  const char* name = nullptr;
  const double metres = crs.IsCompound() ? crs.GetTargetLinearUnits("VERT_CS", &name) : 1.0;
  if (!(metres > 0) || !std::isfinite(metres)) return std::nullopt;
  const std::string_view text = name == nullptr ? "metre" : name;
  if (auto known = vertical_unit(text); known && std::abs(known->metres / metres - 1) < 1e-9) return known;
  return VerticalUnit{std::string(text), metres};
}

}  // namespace

std::optional<VerticalUnit> vertical_unit(std::string_view name) {
  constexpr double kFoot = 0.3048;
  constexpr double kSurveyFoot = 1200.0 / 3937.0;
  struct Known {
    std::string_view alias, name;
    double metres;
  };
  static constexpr std::array kKnown{
      Known{"m", "metre", 1},
      Known{"metre", "metre", 1},
      Known{"meter", "metre", 1},
      Known{"metres", "metre", 1},
      Known{"meters", "metre", 1},
      Known{"ft", "foot", kFoot},
      Known{"foot", "foot", kFoot},
      Known{"feet", "foot", kFoot},
      Known{"international foot", "foot", kFoot},
      Known{"foot_us", "US survey foot", kSurveyFoot},
      Known{"us survey foot", "US survey foot", kSurveyFoot},
      Known{"us_survey_foot", "US survey foot", kSurveyFoot},
      Known{"us survey feet", "US survey foot", kSurveyFoot},
      Known{"us-ft", "US survey foot", kSurveyFoot},
      Known{"ftus", "US survey foot", kSurveyFoot},
      Known{"sfoot", "US survey foot", kSurveyFoot},
      Known{"decimetre", "decimetre", 0.1},
      Known{"dm", "decimetre", 0.1},
      Known{"centimetre", "centimetre", 0.01},
      Known{"cm", "centimetre", 0.01},
      Known{"millimetre", "millimetre", 0.001},
      Known{"mm", "millimetre", 0.001},
      Known{"km", "kilometre", 1000},
      Known{"kilometre", "kilometre", 1000},
  };
  for (const Known& known : kKnown) {
    if (same_letters(name, known.alias)) return VerticalUnit{std::string(known.name), known.metres};
  }
  return std::nullopt;
}

Result<std::unique_ptr<OGRSpatialReference>> parse_crs(std::string_view text) {
  prepare_library();
  const Complaints complaints;
  auto crs = std::make_unique<OGRSpatialReference>();
  crs->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  if (const auto code = epsg_of(text)) {
    if (crs->importFromEPSG(*code) != OGRERR_NONE) {
      return error(Code::kUnsupported, "EPSG knows no coordinate reference system " + std::to_string(*code),
                   "crs");
    }
    return crs;
  }
  if (text.size() <= kLongestWkt && looks_like_wkt(text)) {
    if (crs->importFromWkt(std::string(text).c_str()) == OGRERR_NONE) return crs;
    return error(Code::kMalformed, "The WKT of the coordinate reference system is wrong" + complaints.aside(),
                 "crs");
  }
  return error(Code::kMalformed,
               "A coordinate reference system is named like EPSG:32617 or "
               "http://www.opengis.net/def/crs/EPSG/0/32617",
               "crs");
}

Result<CrsInfo> describe_crs(const OGRSpatialReference& crs) {
  prepare_library();
  const Complaints complaints;
  CrsInfo info;
  if (crs.IsGeocentric() || crs.IsDerivedGeographic() ||
      !(crs.IsGeographic() || crs.IsProjected() || crs.IsLocal())) {
    return error(
        Code::kUnsupported,
        "The coordinate reference system has neither easting and northing nor longitude and latitude", "crs");
  }
  info.scale.geographic = crs.IsGeographic() != FALSE;
  if (info.scale.geographic) {
    constexpr double kDegree = 0.017453292519943295;
    if (std::abs(crs.GetAngularUnits() / kDegree - 1) > 1e-9) {
      return error(Code::kUnsupported, "Geographic coordinate reference systems must be in degrees", "crs");
    }
  } else {
    info.scale.unit_m = crs.GetLinearUnits();
    if (!(info.scale.unit_m > 0) || !std::isfinite(info.scale.unit_m)) {
      return error(Code::kUnsupported, "The coordinate reference system has an unusable unit of length",
                   "crs");
    }
  }
  auto name = canonical_name(crs);
  if (!name) return name.error();
  info.name = *std::move(name);
  info.vertical = vertical_unit_of(crs);
  info.northing_first = crs.EPSGTreatsAsLatLong() != FALSE || crs.EPSGTreatsAsNorthingEasting() != FALSE;
  return info;
}

Result<CrsInfo> read_crs(std::string_view text) {
  auto crs = parse_crs(text);
  if (!crs) return crs.error();
  return describe_crs(**crs);
}

struct CrsTransform::Impl {
  std::unique_ptr<OGRCoordinateTransformation> way;
  std::vector<int> success;
};

CrsTransform::CrsTransform(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
CrsTransform::CrsTransform(CrsTransform&&) noexcept = default;
CrsTransform& CrsTransform::operator=(CrsTransform&&) noexcept = default;
CrsTransform::~CrsTransform() = default;

Result<CrsTransform> CrsTransform::create(std::string_view from, std::string_view to) {
  auto source = parse_crs(from);
  if (!source) return source.error();
  auto target = parse_crs(to);
  if (!target) return target.error();
  const Complaints complaints;
  auto impl = std::make_unique<Impl>();
  impl->way.reset(OGRCreateCoordinateTransformation(source->get(), target->get()));
  if (!impl->way) {
    return error(Code::kUnsupported,
                 "There is no conversion between these coordinate reference systems" + complaints.aside(),
                 "crs");
  }
  return CrsTransform(std::move(impl));
}

bool CrsTransform::transform(std::span<double> x, std::span<double> y, std::span<std::uint8_t> ok) {
  TIN_CHECK(x.size() == y.size() && x.size() == ok.size());
  constexpr std::size_t kAtOnce = 1 << 16;
  const Complaints complaints;
  bool all = true;
  for (std::size_t begin = 0; begin < x.size(); begin += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, x.size() - begin);
    impl_->success.assign(count, FALSE);
    impl_->way->Transform(static_cast<int>(count), x.data() + begin, y.data() + begin, nullptr,
                          impl_->success.data());
    for (std::size_t i = 0; i < count; ++i) {
      double& at_x = x[begin + i];
      double& at_y = y[begin + i];
      const bool good = impl_->success[i] != FALSE && std::isfinite(at_x) && std::isfinite(at_y);
      if (!good) at_x = at_y = std::numeric_limits<double>::infinity();
      ok[begin + i] = good;
      all = all && good;
    }
  }
  return all;
}

}  // namespace server::gdal
