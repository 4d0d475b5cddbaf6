#include "server/api/feature_query.h"

#include <algorithm>
#include <charconv>

#include "proto/crs_uri.h"
#include "proto/datetime.h"
#include "server/gdal/crs.h"

namespace server::api {

using tin::base::Code;
using tin::base::error;
using tin::frame::Frame;

namespace {

/// What an OGC API client may ask for besides the TIN's own: what maps on the web are in.
constexpr std::string_view kAlways[] = {"EPSG:4326", "EPSG:3857"};

Result<PageToken> read_token(const std::string& text) {
  std::uint64_t parts[4] = {};
  const char *at = text.data(), *end = at + text.size();
  for (std::size_t i = 0; i < 4; ++i) {
    const auto read = std::from_chars(at, end, parts[i]);
    const bool last = i == 3;
    if (read.ec != std::errc{} || (last ? read.ptr != end : read.ptr == end || *read.ptr != '.')) break;
    if (last && parts[2] <= UINT32_MAX) return PageToken{parts[0], {parts[1], static_cast<std::uint32_t>(parts[2])}, parts[3]};
    at = read.ptr + 1;
  }
  return error(Code::kMalformed, "This is no token that a page gave.", "query:next");
}

}  // namespace

std::vector<std::string> offered_crs(const Frame& frame) {
  std::vector<std::string> uris;
  if (frame.crs.empty()) return uris;
  uris.emplace_back(proto::kCrs84Uri);
  if (const auto own = proto::crs_uri(frame.crs)) uris.push_back(*own);
  for (const std::string_view name : kAlways) {
    const std::string uri = *proto::crs_uri(name);
    if (std::find(uris.begin(), uris.end(), uri) == uris.end()) uris.push_back(uri);
  }
  return uris;
}

Result<WireCrs> wire_crs(const Frame& frame, const std::optional<std::string>& text, std::string where) {
  if (frame.crs.empty()) {
    if (!text) return WireCrs{};
    return error(Code::kMalformed, "The TIN has no CRS, so positions cannot be converted.", std::move(where));
  }
  const auto name = proto::parse_crs(text.value_or(std::string(proto::kCrs84)), where);
  if (!name) return name.error();
  WireCrs crs{*name, *proto::crs_uri(*name)};
  if (*name == proto::kCrs84) {
    crs.geographic = true;
    return crs;
  }
  const auto offered = offered_crs(frame);
  if (std::find(offered.begin(), offered.end(), crs.uri) == offered.end()) {
    return error(Code::kMalformed, "This CRS is none of those that the collection lists.", std::move(where));
  }
  const auto known = gdal::read_crs(*name);
  if (!known) return error(Code::kMalformed, known.error().message, std::move(where));
  crs.northing_first = known->northing_first;
  crs.geographic = known->scale.geographic;
  return crs;
}

tin::base::Error as_bad_parameter(tin::base::Error problem) {
  if (problem.code == Code::kInvalidValue || problem.code == Code::kNotFinite) problem.code = Code::kMalformed;
  return problem;
}

std::string write_token(const PageToken& token) {
  return std::to_string(token.revision) + "." + std::to_string(token.cursor.vertex) + "." +
         std::to_string(token.cursor.done) + "." + std::to_string(token.matched);
}

Result<FeatureKind> collection_of(const Request& request) {
  const auto kind = feature_kind(request.path_parameter("collection"));
  if (kind) return *kind;
  return error(Code::kNotFound, "There is no such collection of features: there are vertices, triangles and edges.");
}

Result<void> check_datetime(const Request& request) {
  const auto text = request.query_value("datetime");
  if (!text) return {};
  const auto span = proto::parse_datetime(*text, "query:datetime");
  return span ? Result<void>() : span.error();
}

Result<FeatureQuery> read_feature_query(const LimitConfig& limits, const Request& request) {
  FeatureQuery query;
  const auto kind = collection_of(request);
  if (!kind) return kind.error();
  query.kind = *kind;
  query.limit = static_cast<std::size_t>(limits.page_size);
  if (const auto text = request.query_value("limit")) {
    const auto limit = proto::parse_count(*text, 1, UINT32_MAX, "query:limit");
    if (!limit) return as_bad_parameter(limit.error());
    query.limit = static_cast<std::size_t>(
        std::min<std::uint64_t>(*limit, static_cast<std::uint64_t>(limits.page_size_max)));
  }
  if (auto fine = check_datetime(request); !fine) return fine.error();
  if (const auto text = request.query_value("next")) {
    const auto token = read_token(*text);
    if (!token) return token.error();
    query.token = *token;
  }
  return query;
}

Result<std::vector<proto::Bbox>> read_boxes(const Request& request, const WireCrs& bbox_crs) {
  const auto text = request.query_value("bbox");
  if (!text) return std::vector<proto::Bbox>{};
  if (bbox_crs.geographic && !bbox_crs.northing_first) {
    auto boxes = proto::parse_lon_lat_bbox(*text, "query:bbox");
    if (!boxes) return as_bad_parameter(boxes.error());
    return boxes;
  }
  auto box = proto::parse_bbox(*text, "query:bbox");
  if (!box) return as_bad_parameter(box.error());
  if (bbox_crs.northing_first) {
    std::swap(box->min_x, box->min_y);
    std::swap(box->max_x, box->max_y);
  }
  return std::vector<proto::Bbox>{*box};
}

}  // namespace server::api
