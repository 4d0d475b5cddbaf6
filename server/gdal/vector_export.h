// Writing vertices and triangles as layers of a vector file.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>

#include "proto/messages.h"
#include "tin/base/result.h"

namespace server::gdal {

enum class VectorDriver { kGeoPackage, kFlatGeobuf };

enum class VectorLayer {
  kVertices,   // Point Z: id, z
  kTriangles,  // Polygon Z: the ids of its corners as a, b, c
  kSurface,    // TIN Z, in patches of so many triangles; no other format has it
};

struct VectorSpec {
  VectorDriver driver = VectorDriver::kGeoPackage;
  std::string crs;   // any form that read_crs() takes; empty: none
  std::string note;  // kept as metadata of the layers, where the format has some: the terrain's lattice
};

/// A file under construction; a FlatGeobuf has one layer only. Features go to the layer begun last, as they
/// are asked for; memory does not grow with them, but for 50 bytes each in a FlatGeobuf, whose index is made
/// at the end. Equal input gives equal bytes. One thread.
///
/// Errors: kStorage everywhere; as read_crs() from create(). Whoever gets one removes the file.
class VectorFile {
 public:
  /// The name of a FlatGeobuf must end in ".fgb": without it the driver would make a folder.
  static tin::base::Result<VectorFile> create(const std::filesystem::path& out, const VectorSpec& spec);
  VectorFile(VectorFile&&) noexcept;
  ~VectorFile();

  tin::base::Result<void> begin(VectorLayer layer);
  tin::base::Result<void> add_vertex(proto::VertexId id, const proto::Position& at);
  /// To triangles or to the surface.
  tin::base::Result<void> add_triangle(const std::array<proto::VertexId, 3>& ids,
                                       const std::array<proto::Position, 3>& corners);
  /// Completes and closes the file.
  tin::base::Result<void> finish();

 private:
  struct Impl;
  explicit VectorFile(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace server::gdal
