// PLY 1.0, the polygon file format: doubles, so that nothing is lost, in binary or as text.
#pragma once

#include "proto/formats/byte_reader.h"
#include "proto/formats/mesh.h"
#include "proto/formats/mesh_points.h"

namespace proto::formats {

enum class PlyEncoding { kBinary, kAscii };  // little-endian

class PlyFormat : public MeshFormat {
 public:
  explicit PlyFormat(PlyEncoding encoding) : encoding_(encoding) {}
  void begin(std::string& out, const MeshHead& head) override;
  void vertex(std::string& out, const MeshVertex& vertex) override;
  void triangle(std::string& out, const MeshTriangle& triangle) override;

 private:
  const PlyEncoding encoding_;
};

/// Reads x, y and z of the element "vertex", of any of the format's types, in text or binary of either order
/// of bytes. Other elements and properties are passed over. Errors: kMalformed (with the line, in text),
/// kUnsupported, kInvalidValue (no such element or property), kNotFinite, kTooLarge, those of `limits.check`.
tin::base::Result<MeshPoints> read_ply(ByteReader& bytes, const ReadLimits& limits);

}  // namespace proto::formats
