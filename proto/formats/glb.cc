#include "proto/formats/glb.h"

#include <bit>

#include "proto/formats/little_endian.h"
#include "proto/json_write.h"
#include "tin/frame/frame.h"

namespace proto::formats {
namespace {

using tin::base::Code;
using tin::base::error;
using Axes = std::array<double, 3>;

constexpr std::uint64_t kPositionBytes = 12, kTriangleBytes = 12;
constexpr std::uint64_t kFloat = 5126, kUnsignedInt = 5125;           // component types
constexpr std::uint64_t kVertexTarget = 34962, kIndexTarget = 34963;  // buffer targets
constexpr std::uint64_t kPoints = 0, kTriangles = 4;                  // modes
constexpr std::uint32_t kMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

Position middle(const MeshHead& head) {
  const auto between = [](double low, double high) { return low + (high - low) / 2; };
  return {between(head.low.x, head.high.x), between(head.low.y, head.high.y),
          between(head.low.z, head.high.z)};
}

/// As it is stored: local, y up.
std::array<float, 3> local(const Position& at, const Position& origin) {
  return {static_cast<float>(at.x - origin.x), static_cast<float>(at.z - origin.z),
          static_cast<float>(origin.y - at.y)};
}

void write_numbers(JsonWriter& json, std::string_view key, const std::array<float, 3>& values) {
  json.key(key).begin_array();
  for (const float value : values) json.number(static_cast<double>(value));
  json.end_array();
}

/// Metres per local unit, along x, up and along -y.
Axes scales(const MeshHead& head, const Position& origin) {
  if (!head.geographic) return {head.unit_m, head.vertical_unit_m, head.unit_m};
  const auto degree = tin::frame::degree_lengths(origin.y);
  return {degree.lon_m, head.vertical_unit_m, degree.lat_m};
}

void write_node(JsonWriter& json, const MeshHead& head, const Position& origin) {
  const Axes scale = scales(head, origin);
  Axes move{0, 0, 0};
  if (!head.geographic) move = {origin.x * scale[0], origin.z * scale[1], -origin.y * scale[2]};
  json.key("nodes").begin_array().begin_object();
  json.key("name").string(head.title);
  json.key("mesh").integer(0);
  json.key("matrix").begin_array();
  for (std::size_t column = 0; column < 3; ++column) {
    for (std::size_t row = 0; row < 4; ++row) json.number(row == column ? scale[column] : 0);
  }
  for (const double value : move) json.number(value);
  json.number(1).end_array();
  json.key("extras").begin_object();
  json.key("crs").string(head.crs);
  json.key("origin").begin_array().number(origin.x).number(origin.y).number(origin.z).end_array();
  json.key("verticalUnit").string(head.vertical_unit);
  json.end_object().end_object().end_array();
}

void write_mesh(JsonWriter& json, bool triangles) {
  json.key("meshes").begin_array().begin_object();
  json.key("primitives").begin_array().begin_object();
  json.key("attributes").begin_object().key("POSITION").integer(0).end_object();
  if (triangles) json.key("indices").integer(1);
  json.key("mode").integer(triangles ? kTriangles : kPoints);
  json.key("material").integer(0);
  json.end_object().end_array().end_object().end_array();
  json.key("materials").begin_array().begin_object();
  json.key("name").string("terrain");
  json.key("doubleSided").boolean(true);
  json.key("pbrMetallicRoughness").begin_object();
  json.key("metallicFactor").integer(0).key("roughnessFactor").integer(1).end_object();
  json.end_object().end_array();
}

void write_accessors(JsonWriter& json, const MeshHead& head, const Position& origin) {
  // y is turned round, so its largest becomes the smallest.
  const auto low = local({head.low.x, head.high.y, head.low.z}, origin);
  const auto high = local({head.high.x, head.low.y, head.high.z}, origin);
  json.key("accessors").begin_array().begin_object();
  json.key("bufferView").integer(0).key("componentType").integer(kFloat);
  json.key("count").integer(head.vertices).key("type").string("VEC3");
  write_numbers(json, "min", low);
  write_numbers(json, "max", high);
  json.end_object();
  if (head.triangles > 0) {
    json.begin_object().key("bufferView").integer(1).key("componentType").integer(kUnsignedInt);
    json.key("count").integer(3 * head.triangles).key("type").string("SCALAR").end_object();
  }
  json.end_array();
}

void write_buffers(JsonWriter& json, const MeshHead& head) {
  const std::uint64_t positions = head.vertices * kPositionBytes, indices = head.triangles * kTriangleBytes;
  json.key("bufferViews").begin_array().begin_object();
  json.key("buffer").integer(0).key("byteOffset").integer(0).key("byteLength").integer(positions);
  json.key("target").integer(kVertexTarget).end_object();
  if (indices > 0) {
    json.begin_object().key("buffer").integer(0).key("byteOffset").integer(positions);
    json.key("byteLength").integer(indices).key("target").integer(kIndexTarget).end_object();
  }
  json.end_array();
  json.key("buffers").begin_array().begin_object();
  json.key("byteLength").integer(positions + indices).end_object().end_array();
}

std::string document(const MeshHead& head, const Position& origin) {
  JsonWriter json;
  json.begin_object();
  json.key("asset").begin_object().key("version").string("2.0").key("generator").string("Tinsmith");
  json.end_object();
  json.key("scene").integer(0);
  json.key("scenes").begin_array().begin_object().key("nodes").begin_array().integer(0).end_array();
  json.end_object().end_array();
  write_node(json, head, origin);
  write_mesh(json, head.triangles > 0);
  write_accessors(json, head, origin);
  write_buffers(json, head);
  json.end_object();
  std::string text = json.take();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  return text;
}

}  // namespace

tin::base::Result<void> GlbFormat::check(const MeshHead& head) const {
  constexpr std::uint64_t kJsonRoom = 1 << 20;
  if (head.vertices * kPositionBytes + head.triangles * kTriangleBytes < (std::uint64_t{1} << 32) - kJsonRoom)
    return {};
  return error(Code::kTooLarge, "A GLB file cannot hold so large a mesh: ask for a smaller box.", "query:f");
}

void GlbFormat::begin(std::string& out, const MeshHead& head) {
  origin_ = middle(head);
  const std::string json = document(head, origin_);
  const auto binary =
      static_cast<std::uint32_t>(head.vertices * kPositionBytes + head.triangles * kTriangleBytes);
  const auto length = static_cast<std::uint32_t>(json.size());
  for (const std::uint32_t word :
       {kMagic, std::uint32_t{2}, 12 + 8 + length + 8 + binary, length, kJsonChunk})
    append_little(out, word);
  out += json;
  append_little(out, binary);
  append_little(out, kBinaryChunk);
}

void GlbFormat::vertex(std::string& out, const MeshVertex& vertex) {
  for (const float value : local(vertex.at, origin_)) append_little(out, std::bit_cast<std::uint32_t>(value));
}

void GlbFormat::triangle(std::string& out, const MeshTriangle& triangle) {
  for (const std::uint32_t corner : triangle.corners) append_little(out, corner);
}

}  // namespace proto::formats
