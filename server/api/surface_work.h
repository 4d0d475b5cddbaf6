// What the resources and processes that ask about a TIN's surface have in common: from the question on the
// wire to the engine's terms, and back.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "proto/formats/geojson.h"
#include "proto/surface_queries.h"
#include "server/api/answer.h"
#include "server/api/positions.h"
#include "server/api/routes.h"
#include "server/app/version.h"
#include "tin/frame/ground.h"
#include "tin/query/contour.h"
#include "tin/query/region.h"

namespace server::api {

tin::query::Voids engine_voids(proto::Voids voids);
proto::Units units_of(const tin::terrain::Terrain& terrain);

/// How lengths of a TIN's CRS compare with metres. Errors: as gdal::read_crs().
Result<tin::frame::Ground> ground_of(const tin::terrain::Terrain& terrain);

/// Positions between a question's CRS and the lattice of one TIN.
class SurfacePositions {
 public:
  /// Errors: as Positions::between(), at `where`.
  static Result<SurfacePositions> make(const tin::terrain::Terrain& terrain,
                                       const std::optional<std::string>& crs, std::string where);

  /// Lattice points. Errors: kOutsideLattice (also where the CRS has no counterpart) at `where` + "/i".
  Result<std::vector<tin::exact::Point>> to_lattice(std::span<const proto::Position2> positions,
                                                    const std::string& where);
  Result<tin::exact::Point> to_lattice(proto::Position2 position, const std::string& where);
  /// The nearest lattice point where there is one.
  std::vector<std::optional<tin::exact::Point>> nearest(std::span<const proto::Position2> positions);
  /// Positions in the question's CRS.
  std::vector<proto::Position2> from_lattice(std::span<const tin::frame::Place> places);
  /// What of the plane is meant; nothing: everything. Sides of a box in another CRS are followed in 32 parts
  /// each. Errors: as to_lattice(), and query::Region::make(), at `where` + "polygon" or "bbox".
  Result<std::optional<tin::query::Region>> region(const proto::AreaOfInterest& area,
                                                   const std::string& where);
  /// The box around a box, on the lattice; not clamped to it.
  Result<tin::query::PlaceBox> box(const proto::Bbox& box, const std::string& where);

  bool identity() const { return to_own_.identity(); }

 private:
  SurfacePositions(const tin::frame::Frame& frame, Positions to_own, Positions from_own)
      : frame_(&frame), to_own_(std::move(to_own)), from_own_(std::move(from_own)) {}
  std::vector<proto::Position2> outline(const proto::Bbox& box) const;

  const tin::frame::Frame* frame_;
  Positions to_own_, from_own_;
};

/// The members "crs" and "voids" of a query string. Errors: as proto::parse_crs(), parse_voids().
Result<proto::Manner> manner_of(const Request& request);
/// A number that must be there, or one that may be. Errors: kMalformed, kNotFinite.
Result<double> required_number(const Request& request, const std::string& name);
Result<double> number_or(const Request& request, const std::string& name, double otherwise);
/// The parameter "bbox" where only x and y count. Errors: kMalformed, kInvalidValue.
Result<std::optional<proto::Bbox>> flat_box(const Request& request);
/// The parameters "bbox" and "polygon", and those of manner_of(). Errors: kMalformed, kInvalidValue (both),
/// kTooLarge.
Result<proto::AreaInputs> area_inputs_of(const Request& request, const LimitConfig& limits);
/// The members "positions", "crs" and "voids" of a body of JSON. Errors: as proto::read_positions_inputs().
Result<proto::PositionsInputs> positions_of_body(const Request& request, const LimitConfig& limits);

/// What takes all triangles into account has a bounded number of places, beside the rasters.
tin::base::Error too_many_questions();

/// A JSON body, or its error, as the answer about a revision.
Result<Response> tagged(Result<std::string> body, const app::Tin& tin, std::uint64_t revision,
                        const Request& request);

// Answers as JSON, for both GET and processes. `where` is what precedes a member's name in errors: "query:"
// or "/inputs/".
Result<std::string> profile_answer(const app::Version& version, const proto::PositionsInputs& inputs,
                                   const LimitConfig& limits, const std::string& where);
Result<std::string> sight_answer(const app::Version& version, const proto::SightInputs& inputs,
                                 const LimitConfig& limits, const std::string& where);
/// A GeoJSON feature collection. Errors: kTooLarge beyond the limits on levels and positions.
Result<std::string> contours_answer(const app::Version& version, const proto::ContourInputs& inputs,
                                    const LimitConfig& limits, const std::string& where,
                                    tin::base::Progress* progress);
Result<std::string> volume_answer(const app::Version& version, const proto::VolumeInputs& inputs,
                                  const std::string& where, tin::base::Progress* progress);
Result<std::string> surface_area_answer(const app::Version& version, const proto::AreaInputs& inputs,
                                        const std::string& where, tin::base::Progress* progress);
Result<std::string> cut_fill_answer(const app::Version& before, const app::Version& after,
                                    std::string_view after_id, const proto::AreaInputs& inputs,
                                    const std::string& where, tin::base::Progress* progress);

/// Contours as GeoJSON, line by line: in the CRS of the question, else in CRS84 (in a local CRS as they are).
class ContourFile {
 public:
  /// Errors: as proto::check_contour_inputs() and query::contour_levels(), at `where`. Cost: O(triangles).
  static Result<ContourFile> begin(app::Version version, const proto::ContourInputs& inputs,
                                   const LimitConfig& limits, const std::string& where);
  /// Appends the next part; false after the last. `positions`, if given, grows by what was written.
  bool next(std::string& out, std::size_t* positions = nullptr);
  double fraction() const { return tracer_->fraction(); }

 private:
  explicit ContourFile(app::Version version) : version_(std::move(version)) {}

  app::Version version_;
  std::optional<SurfacePositions> positions_;
  std::unique_ptr<tin::query::ContourTracer> tracer_;
  proto::formats::Coordinates coordinates_ = proto::formats::Coordinates::kProjected;
  std::optional<std::string> crs_urn_;
  bool begun_ = false, begun_lines_ = false, ended_ = false;
};

}  // namespace server::api
