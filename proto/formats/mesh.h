// A surface as a mesh of triangles, and how it becomes the bytes of a file, piece by piece.
//
//   auto mesh = TerrainMesh::create(terrain, {});
//   auto format = make_mesh_format("obj");
//   MeshStream stream(**mesh, *format);
//   for (std::string piece; stream.next(piece);) file << piece;
//
// Every format has the same five parts, so that none has a loop of its own: what stands before the vertices,
// each vertex, what stands between, each triangle, and the end.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "proto/messages.h"
#include "tin/base/result.h"
#include "tin/frame/frame.h"

namespace proto::formats {

/// What a file says of its mesh before the first vertex.
struct MeshHead {
  std::string title;
  std::string crs;          // of the coordinates: "EPSG:n" or WKT; empty: local
  bool geographic = false;  // x and y are longitude and latitude in degrees
  double unit_m = 1;        // metres per unit of x and y, where they are no degrees
  std::string vertical_unit;
  double vertical_unit_m = 1;
  /// The lattice that the coordinates lie on, so that a file may tell it and come home to the same terrain;
  /// nothing when they were converted from another CRS.
  std::optional<tin::frame::Frame> frame;
  std::uint64_t vertices = 0;   // at least 1
  std::uint64_t triangles = 0;  // visible ones
  std::uint64_t hidden = 0;     // those over voids
  Position low, high;           // of the vertices
};

struct MeshVertex {
  VertexId id;
  Position at;
};

/// Corners are numbers of vertices, from 0 in the order in which they come; counter-clockwise from above.
struct MeshTriangle {
  std::array<std::uint32_t, 3> corners{};
  bool hidden = false;
};

/// A mesh that can be read in order, once after each rewind().
class MeshSource {
 public:
  virtual ~MeshSource() = default;
  virtual const MeshHead& head() const = 0;
  virtual void rewind() = 0;
  /// False after the last.
  virtual bool next_vertex(MeshVertex& vertex) = 0;
  virtual bool next_triangle(MeshTriangle& triangle) = 0;
};

/// A format: appends each part of a file to `out`, which the caller may empty between any two calls.
class MeshFormat {
 public:
  virtual ~MeshFormat() = default;
  /// Why the mesh cannot be said in this format. Errors: kTooLarge.
  virtual tin::base::Result<void> check(const MeshHead&) const { return {}; }
  virtual bool has_triangles() const { return true; }
  virtual bool has_hidden_triangles() const { return false; }

  virtual void begin(std::string& out, const MeshHead& head) = 0;
  virtual void vertex(std::string& out, const MeshVertex& vertex) = 0;
  virtual void between(std::string&) {}
  virtual void triangle(std::string&, const MeshTriangle&) {}
  virtual void end(std::string&) {}
};

/// The bytes of a mesh in a format. Borrows both.
class MeshStream {
 public:
  MeshStream(MeshSource& source, MeshFormat& format);
  /// The next bytes (about kPiece), or false after the last.
  bool next(std::string& piece);

  static constexpr std::size_t kPiece = 64 * 1024;

 private:
  enum class Part { kBegin, kVertices, kTriangles, kDone };
  void step(std::string& out);

  MeshSource& source_;
  MeshFormat& format_;
  Part part_ = Part::kBegin;
};

/// Takes bytes; an error ends the writing.
using Sink = std::function<tin::base::Result<void>(std::string_view)>;

/// All of a mesh into a sink. Errors: those of format.check() and of the sink.
tin::base::Result<void> write_mesh(MeshSource& source, MeshFormat& format, const Sink& sink);

}  // namespace proto::formats
