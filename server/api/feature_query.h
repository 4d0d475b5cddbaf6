// What the query of a request for features says: CRSs (OGC API Features Part 2), boxes, time, and where to go on.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "proto/bbox.h"
#include "server/api/answer.h"
#include "server/api/feature_reader.h"
#include "server/config.h"

namespace server::api {

/// A CRS as clients see it: with a URI, and in its authority's order of coordinates.
struct WireCrs {
  std::string name;             // as read_crs() takes it; empty: the TIN has no CRS
  std::string uri;              // empty: likewise
  bool northing_first = false;  // latitude or northing is the first coordinate
  bool geographic = false;
};

/// The URIs of the CRSs that features of a TIN in this frame can be had in; none when it has no CRS.
std::vector<std::string> offered_crs(const tin::frame::Frame& frame);

/// The CRS that a parameter or header field names, CRS84 without one. Errors: kMalformed at `where`: none of offered_crs().
Result<WireCrs> wire_crs(const tin::frame::Frame& frame, const std::optional<std::string>& text, std::string where);

/// OGC API Features knows one status for parameters with a wrong value, 400.
tin::base::Error as_bad_parameter(tin::base::Error problem);

/// What a `next` token says: a revision, where to go on in it, and how many features match in all.
struct PageToken {
  std::uint64_t revision = 0;
  FeatureCursor cursor;
  std::uint64_t matched = 0;
};
std::string write_token(const PageToken& token);

struct FeatureQuery {
  FeatureKind kind = FeatureKind::kVertices;
  std::size_t limit = 0;
  std::vector<proto::Bbox> boxes;  // in bbox_crs, easting or longitude first; none: everything
  std::optional<PageToken> token;
};

/// Reads "datetime" and forgets it: what a TIN has is of no time, so it selects nothing. Errors: kMalformed.
Result<void> check_datetime(const Request& request);

/// Reads limit, bbox, bbox-crs, datetime and next. Errors: kMalformed at "query:..."; kNotFound for the collection.
Result<FeatureQuery> read_feature_query(const LimitConfig& limits, const Request& request);

/// The kind that the path names. Errors: kNotFound.
Result<FeatureKind> collection_of(const Request& request);

/// The boxes of "bbox" in the CRS of "bbox-crs". Errors: kMalformed.
Result<std::vector<proto::Bbox>> read_boxes(const Request& request, const WireCrs& bbox_crs);

}  // namespace server::api
