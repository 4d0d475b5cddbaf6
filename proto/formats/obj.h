// Wavefront OBJ: vertices as "v x y z" with z up, triangles as "f a b c" with numbers from 1.
#pragma once

#include "proto/formats/byte_reader.h"
#include "proto/formats/mesh.h"
#include "proto/formats/mesh_points.h"

namespace proto::formats {

class ObjFormat : public MeshFormat {
 public:
  void begin(std::string& out, const MeshHead& head) override;
  void vertex(std::string& out, const MeshVertex& vertex) override;
  void triangle(std::string& out, const MeshTriangle& triangle) override;
};

/// Reads the vertices: lines "v x y z", where more numbers (a weight, colours) may follow; z is taken as up.
/// Faces are checked and left out; all other lines are passed over. Errors: kMalformed with the line,
/// kNotFinite, kTooLarge, those of `limits.check`.
tin::base::Result<MeshPoints> read_obj(ByteReader& bytes, const ReadLimits& limits);

}  // namespace proto::formats
