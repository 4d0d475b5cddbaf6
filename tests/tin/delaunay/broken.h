#pragma once

#include <string>

#include "tin/delaunay/triangulation.h"
#include "tin/mesh/validate.h"

namespace support {

/// "" when the mesh is valid, else what is broken.
inline std::string broken(const tin::delaunay::Triangulation& t) {
  return tin::mesh::validate(t.mesh()).value_or("");
}

}  // namespace support
