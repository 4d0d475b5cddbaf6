// All formats that a mesh is written in, in one table.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "proto/formats/mesh.h"

namespace proto::formats {

struct MeshFormatEntry {
  std::string_view name;    // as in f=obj
  std::string_view title;   // "Wavefront OBJ"
  std::string_view suffix;  // ".obj"
  std::string_view media_type;
  std::unique_ptr<MeshFormat> (*make)();
  bool degrees = true;  // whether it can hold longitudes and latitudes
};

std::span<const MeshFormatEntry> mesh_formats();

/// The entry of this name, or null.
const MeshFormatEntry* find_mesh_format(std::string_view name);

}  // namespace proto::formats
