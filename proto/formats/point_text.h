// Vertices as text in columns: CSV with a header, XYZ without.
#pragma once

#include "proto/formats/mesh.h"

namespace proto::formats {

/// "id,x,y,z", or "id,lon,lat,z" for WGS 84, which readers then know without being told.
class CsvFormat : public MeshFormat {
 public:
  bool has_triangles() const override { return false; }
  void begin(std::string& out, const MeshHead& head) override;
  void vertex(std::string& out, const MeshVertex& vertex) override;
};

/// "x y z" after comments that begin with '#'.
class XyzFormat : public MeshFormat {
 public:
  bool has_triangles() const override { return false; }
  void begin(std::string& out, const MeshHead& head) override;
  void vertex(std::string& out, const MeshVertex& vertex) override;
};

}  // namespace proto::formats
