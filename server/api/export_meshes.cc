// Exports that stream the mesh in one of proto/formats.
#include "proto/formats/mesh_formats.h"
#include "proto/formats/terrain_mesh.h"
#include "server/api/export_coordinates.h"
#include "server/api/export_formats.h"

namespace server::api {

using proto::formats::MeshFormat;
using proto::formats::MeshRequest;
using proto::formats::MeshStream;
using proto::formats::TerrainMesh;

namespace {

/// A file made while the client takes it, from one version.
class MeshBody : public http::BodySource {
 public:
  MeshBody(app::Version version, std::unique_ptr<TerrainMesh> mesh, std::unique_ptr<MeshFormat> format)
      : version_(std::move(version)),
        mesh_(std::move(mesh)),
        format_(std::move(format)),
        stream_(*mesh_, *format_) {}
  bool next(std::string& piece) override { return stream_.next(piece); }

 private:
  const app::Version version_;
  const std::unique_ptr<TerrainMesh> mesh_;
  const std::unique_ptr<MeshFormat> format_;
  MeshStream stream_;
};

/// What the export asks for, of the TIN as it is or converted.
Result<MeshRequest> request_of(const ExportTask& task) {
  auto request = mesh_request(task.terrain().frame(), task.wanted.crs);
  if (!request) return request;
  request->title = task.tin.title().empty() ? task.tin.id() : task.tin.title();
  request->box = task.wanted.box;
  request->voids = task.wanted.voids == tin::query::Voids::kFill ? proto::Voids::kFill : proto::Voids::kKeep;
  request->check = [patience = task.patience] { return patience.check(); };
  return request;
}

}  // namespace

Result<http::Body> export_mesh(ExportTask& task) {
  const Slot slot(task.context.exports);
  if (!slot.taken()) return too_many_exports();
  auto request = request_of(task);
  if (!request) return request.error();
  auto mesh = TerrainMesh::create(task.terrain(), std::move(*request));
  if (!mesh) return mesh.error();
  auto format = proto::formats::find_mesh_format(task.format.name)->make();
  if (auto fine = format->check((*mesh)->head()); !fine) return fine.error();
  return http::Body(std::make_unique<MeshBody>(task.version, std::move(*mesh), std::move(format)));
}

}  // namespace server::api
