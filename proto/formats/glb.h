// glTF 2.0 in one binary file: a mesh for viewers and game engines.
//
// glTF is y-up, right-handed, in metres, with float32 positions. So positions are differences from a local
// origin (the middle of the extent), as x, z, -y, and the node's matrix brings them to metres: for projected
// coordinates it also moves them to where they are, for degrees it scales by their lengths at the origin and
// leaves the origin at (0, 0, 0). The origin in full precision and the CRS stand in the node's extras.
#pragma once

#include "proto/formats/mesh.h"

namespace proto::formats {

class GlbFormat : public MeshFormat {
 public:
  /// Errors: kTooLarge for a file of 4 GiB and more, which its lengths cannot say.
  tin::base::Result<void> check(const MeshHead& head) const override;
  void begin(std::string& out, const MeshHead& head) override;
  void vertex(std::string& out, const MeshVertex& vertex) override;
  void triangle(std::string& out, const MeshTriangle& triangle) override;

 private:
  Position origin_;
};

}  // namespace proto::formats
