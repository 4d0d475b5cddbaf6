// Readers of mesh files with code of their own, triangles and all: the judges of what proto/formats writes.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tin/terrain/terrain.h"

namespace tests::formats {

struct ParsedMesh {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // numbers from 0
  std::size_t hidden = 0;                               // of the triangles, where a format says so
};

ParsedMesh parse_obj(const std::string& text);
ParsedMesh parse_ply(const std::string& bytes);
ParsedMesh parse_2dm(const std::string& text);
ParsedMesh parse_landxml(const std::string& text);
ParsedMesh parse_cityjson(const std::string& text);
/// In the coordinates of the file's scene turned back to z up: metres.
ParsedMesh parse_glb(const std::string& bytes);

/// Expects that the file holds the terrain's vertices in the order of their ids, and its triangles, all
/// counter-clockwise. Positions may differ by `across` and heights by `up`.
void expect_mesh_of(const ParsedMesh& parsed, const tin::terrain::Terrain& terrain, double across = 0,
                    double up = 0);

}  // namespace tests::formats
