// What goes over the wire, as plain structs. openapi.json is the contract; these are its C++ side.
//
// Coordinates are in world units of the CRS that the message names, else of the TIN's own: x is easting or
// longitude, y northing or latitude, z in the TIN's vertical unit. Reading checks everything that needs no
// TIN to be known and says where it is wrong (a JSON pointer). Writing is deterministic: fixed order of
// members, shortest numbers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "tin/base/result.h"
#include "tin/query/elevation.h"
#include "tin/terrain/edit.h"

namespace proto {

using VertexId = tin::terrain::VertexId;

struct Position {
  double x = 0, y = 0, z = 0;
  friend bool operator==(const Position&, const Position&) = default;
};

struct Position2 {
  double x = 0, y = 0;
  friend bool operator==(const Position2&, const Position2&) = default;
};

// Requests ------------------------------------------------------------------------

/// Ids that clients may choose for a TIN: ^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$
bool is_tin_id(std::string_view id);

/// A title has at most 512 bytes and no control characters. Errors: kTooLarge, kInvalidValue.
tin::base::Result<void> check_title(std::string_view title, std::string where);

/// "replace", "keep", "mean", "max", "min" or "reject". Errors: kInvalidValue.
tin::base::Result<tin::terrain::Duplicates> parse_duplicates(std::string_view text, std::string where);

/// Whether places that were void in the source raster have an elevation.
enum class Voids { kKeep, kFill };
/// "keep" or "fill". Errors: kInvalidValue.
tin::base::Result<Voids> parse_voids(std::string_view text, std::string where);

/// "linear" or "natural-neighbour". Errors: kInvalidValue.
tin::base::Result<tin::query::Interpolation> parse_interpolation(std::string_view text, std::string where);

/// POST /tins with application/json.
struct CreateTin {
  std::optional<std::string> id;
  std::optional<std::string> title;
  std::optional<std::string> crs;                   // as parse_crs() gives it: "EPSG:32617"
  std::optional<std::array<double, 2>> resolution;  // lattice steps in x and y, > 0
  std::optional<Position2> origin;
  std::optional<std::string> vertical_unit;
  tin::terrain::Duplicates duplicates = tin::terrain::Duplicates::kReplace;
  std::vector<Position> vertices;
};
tin::base::Result<CreateTin> read_create_tin(std::string_view body, std::size_t max_vertices);

/// Who makes a revision and why, as they say; either may be empty.
struct Remark {
  std::string author;
  std::string note;
};

struct InsertOp {
  double x = 0, y = 0, z = 0;
};
struct RemoveOp {
  VertexId id;
};
struct MoveOp {
  VertexId id;
  double x = 0, y = 0;
};
struct SetZOp {
  VertexId id;
  double z = 0;
};
struct RemoveWithinOp {
  std::vector<Position2> polygon;  // at least three
};
using EditOp = std::variant<InsertOp, RemoveOp, MoveOp, SetZOp, RemoveWithinOp>;

/// POST /tins/{tin}/edits. ops[i] stands at "/ops/i" in the body.
struct EditRequest {
  std::vector<EditOp> ops;
  std::optional<std::string> crs;
  Remark remark;
};
struct EditLimits {
  std::size_t ops = 0;
  std::size_t areas = 0;              // operations that concern an area
  std::size_t polygon_positions = 0;  // of each of these
};
tin::base::Result<EditRequest> read_edit_request(std::string_view body, const EditLimits& limits);

/// POST /tins/{tin}/elevation.
struct ElevationRequest {
  std::vector<Position2> positions;
  std::optional<std::string> crs;
  Voids voids = Voids::kKeep;
  tin::query::Interpolation interpolation = tin::query::Interpolation::kLinear;
};
tin::base::Result<ElevationRequest> read_elevation_request(std::string_view body, std::size_t max_positions);

// Answers -------------------------------------------------------------------------

struct Link {
  std::string href;
  std::string rel;
  std::string type;
  std::string title;  // left out when empty
};

/// What the source raster of a TIN was.
struct SourceInfo {
  std::int64_t width = 0, height = 0;
  std::string data_type;
  std::optional<double> nodata;
};

struct TinDocument {
  std::string id;
  std::string title;
  std::string crs;  // null when empty
  std::array<double, 2> resolution{};
  Position2 origin;
  std::uint64_t revision = 0;
  std::uint64_t vertex_count = 0;
  std::uint64_t triangle_count = 0;
  std::optional<std::array<double, 4>> bbox;  // min x, min y, max x, max y in the TIN's CRS; null when empty
  std::optional<std::array<double, 2>> z_range;  // null when empty
  std::string digest;
  std::string vertical_unit;  // null when empty: not known
  std::optional<SourceInfo> source;
  std::vector<Link> links;
};
struct SimplifyResults;  // processes/simplify.h
/// What came of the data file that a TIN has just been made of.
struct FileReport {
  std::uint64_t duplicates = 0;                     // points that stand where another does
  const SimplifyResults* simplification = nullptr;  // if it was simplified on its way in
};
std::string tin_json(const TinDocument& tin, const FileReport* file = nullptr);

struct TinList {
  std::vector<TinDocument> tins;
  std::uint64_t number_matched = 0;
  std::vector<Link> links;
};
std::string tin_list_json(const TinList& list);

/// An operation that concerned an area, by its index, and how many vertices that were.
using AreaResult = std::pair<std::size_t, std::size_t>;

/// One id per op, of the vertex inserted or found, removed, moved or set; of an op in `areas` (ascending) as
/// many as it removed.
std::string edit_result_json(std::uint64_t revision, std::span<const VertexId> ids,
                             std::span<const AreaResult> areas = {});

struct ElevationAnswer {
  std::optional<double> z;                          // null outside the hull and in voids
  std::optional<std::array<VertexId, 3>> triangle;  // null where no triangle is
  std::uint64_t revision = 0;
};
std::string elevation_json(const ElevationAnswer& answer);
std::string elevations_json(std::span<const std::optional<double>> z, std::uint64_t revision);

struct Landing {
  std::string title;
  std::string description;
  std::vector<Link> links;
};
std::string landing_json(const Landing& landing);
std::string conformance_json(std::span<const std::string> classes);
/// {"status": "ok", "version": ...}
std::string health_json(std::string_view status, std::string_view version);

/// One OGC feature collection of a TIN.
/// A way to query a collection as OGC API EDR knows them: "position", "items" ...
struct DataQuery {
  std::string type;
  std::string href;
  std::string title;
  std::vector<std::string> formats;  // the first is the default
};

struct CollectionDocument {
  std::string id;
  std::string title;
  std::string description;
  std::optional<std::array<double, 4>> bbox;  // CRS84
  std::vector<std::string> crs;               // URIs
  std::string storage_crs;                    // URI; left out when empty
  bool features = true;                       // has items; else it is a coverage
  std::vector<Link> links;
  std::vector<DataQuery> queries;
  std::vector<std::string> formats;  // of all queries
  std::string vertical_unit;         // of elevations; empty: not known
};
std::string collection_json(const CollectionDocument& collection);
std::string collections_json(std::span<const CollectionDocument> collections, std::span<const Link> links);

enum class JobState { kAccepted, kRunning, kSuccessful, kFailed, kDismissed };
std::string_view job_state_name(JobState state);
/// Nothing for other names.
std::optional<JobState> job_state(std::string_view name);

/// Times are RFC 3339 texts in UTC; those that are empty are left out, as is an empty message.
struct JobStatus {
  std::string id;
  std::string process;
  JobState state = JobState::kAccepted;
  int progress = 0;  // 0 to 100
  std::string created, started, finished;
  std::string message;
  std::vector<Link> links;
};
std::string job_json(const JobStatus& job);
std::string job_list_json(std::span<const JobStatus> jobs, std::span<const Link> links);

}  // namespace proto
