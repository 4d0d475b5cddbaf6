// CityJSON 1.1 with one TINRelief: vertices as integers of a transform, which are the lattice's own where the
// coordinates are; heights are whole thousandths of the vertical unit.
#pragma once

#include "proto/formats/mesh.h"

namespace proto::formats {

class CityJsonFormat : public MeshFormat {
 public:
  void begin(std::string& out, const MeshHead& head) override;
  void vertex(std::string& out, const MeshVertex& vertex) override;
  void between(std::string& out) override;
  void triangle(std::string& out, const MeshTriangle& triangle) override;
  void end(std::string& out) override;

 private:
  std::array<double, 3> scale_{1, 1, 1};
  Position origin_;
  bool first_ = true;
};

}  // namespace proto::formats
