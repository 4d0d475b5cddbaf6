// LandXML 1.2: one surface, Pnts with "northing easting elevation", Faces with three ids; those over voids
// are marked as invisible (i="1").
#pragma once

#include "proto/formats/byte_reader.h"
#include "proto/formats/mesh.h"
#include "proto/formats/mesh_points.h"

namespace proto::formats {

class LandXmlFormat : public MeshFormat {
 public:
  /// Errors: kInvalidValue for degrees, and for a unit of length that LandXML does not know.
  tin::base::Result<void> check(const MeshHead& head) const override;
  bool has_hidden_triangles() const override { return true; }
  void begin(std::string& out, const MeshHead& head) override;
  void vertex(std::string& out, const MeshVertex& vertex) override;
  void between(std::string& out) override;
  void triangle(std::string& out, const MeshTriangle& triangle) override;
  void end(std::string& out) override;

 private:
  std::uint64_t vertices_ = 0;
  std::string note_;
};

/// Reads the points of a surface: of the one that is called `surface`, else of the first that has points.
/// Faces are not kept; points that only invisible faces use are left out, unless the file is ours. Of other
/// versions than 1.2 the same elements are read, in any namespace.
///
/// A hostile document gets no further than its first declaration: there are no entities, the elements may be
/// 64 deep, and a tag at most 1 MiB long.
/// Errors: kMalformed with the line, kUnsupported (a document type, points that refer to others),
/// kInvalidValue (no such surface), kNotFinite, kTooLarge, those of `limits.check`.
tin::base::Result<MeshPoints> read_landxml(ByteReader& bytes, const std::string& surface,
                                           const ReadLimits& limits);

}  // namespace proto::formats
