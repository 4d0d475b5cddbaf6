// 2DM, the mesh format of SMS that QGIS reads: "ND id x y z" and "E3T id a b c material", numbers from 1.
#pragma once

#include "proto/formats/byte_reader.h"
#include "proto/formats/mesh.h"
#include "proto/formats/mesh_points.h"

namespace proto::formats {

class Sms2dmFormat : public MeshFormat {
 public:
  void begin(std::string& out, const MeshHead& head) override;
  void vertex(std::string& out, const MeshVertex& vertex) override;
  void triangle(std::string& out, const MeshTriangle& triangle) override;

 private:
  std::uint64_t vertices_ = 0, triangles_ = 0;
};

/// Reads the nodes in the order of the file; elements and other cards are passed over.
/// Errors: kMalformed with the line (also when the first line is not MESH2D), kNotFinite, kTooLarge, those of
/// `limits.check`.
tin::base::Result<MeshPoints> read_2dm(ByteReader& bytes, const ReadLimits& limits);

}  // namespace proto::formats
