// Names of coordinate reference systems on the wire: "EPSG:32617", OGC URIs and URNs.
//
//   parse_crs("http://www.opengis.net/def/crs/EPSG/0/32617", "query:crs")  // "EPSG:32617"
//   crs_uri("EPSG:32617")  // "http://www.opengis.net/def/crs/EPSG/0/32617"
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "tin/base/result.h"

namespace proto {

/// WGS 84 with longitude before latitude: what GeoJSON is in.
inline constexpr std::string_view kCrs84 = "OGC:CRS84";
inline constexpr std::string_view kCrs84Uri = "http://www.opengis.net/def/crs/OGC/1.3/CRS84";

/// "EPSG:n" or "OGC:CRS84" from that name itself (in any case of letters), its URI (any version), or its URN.
/// Whether the code exists is not known here. Errors: kMalformed at `where`.
tin::base::Result<std::string> parse_crs(std::string_view text, std::string where);

/// The URI or URN of a name as parse_crs() gives it; nothing for other texts (WKT, no CRS).
std::optional<std::string> crs_uri(std::string_view name);
std::optional<std::string> crs_urn(std::string_view name);

}  // namespace proto
