#include "proto/formats/mesh.h"

namespace proto::formats {

MeshStream::MeshStream(MeshSource& source, MeshFormat& format) : source_(source), format_(format) {
  source_.rewind();
}

bool MeshStream::next(std::string& piece) {
  piece.clear();
  while (part_ != Part::kDone && piece.size() < kPiece) step(piece);
  return !piece.empty();
}

void MeshStream::step(std::string& out) {
  switch (part_) {
    case Part::kBegin:
      format_.begin(out, source_.head());
      part_ = Part::kVertices;
      return;
    case Part::kVertices:
      if (MeshVertex vertex; source_.next_vertex(vertex)) {
        format_.vertex(out, vertex);
      } else {
        format_.between(out);
        part_ = Part::kTriangles;
      }
      return;
    case Part::kTriangles:
      if (MeshTriangle triangle; format_.has_triangles() && source_.next_triangle(triangle)) {
        if (!triangle.hidden || format_.has_hidden_triangles()) format_.triangle(out, triangle);
      } else {
        format_.end(out);
        part_ = Part::kDone;
      }
      return;
    case Part::kDone:
      return;
  }
}

tin::base::Result<void> write_mesh(MeshSource& source, MeshFormat& format, const Sink& sink) {
  if (auto fine = format.check(source.head()); !fine) return fine.error();
  MeshStream stream(source, format);
  for (std::string piece; stream.next(piece);) {
    if (auto taken = sink(piece); !taken) return taken.error();
  }
  return {};
}

}  // namespace proto::formats
