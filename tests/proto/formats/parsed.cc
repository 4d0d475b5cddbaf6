#include "tests/proto/formats/parsed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

namespace tests::formats {
namespace {

using Json = nlohmann::json;
using Triangle = std::array<std::uint32_t, 3>;

template <class T>
T at(const std::string& bytes, std::size_t offset) {
  T value{};
  EXPECT_LE(offset + sizeof value, bytes.size());
  if (offset + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

Triangle smallest_first(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

}  // namespace

ParsedMesh parse_obj(const std::string& text) {
  ParsedMesh mesh;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "v") {
      std::array<double, 3> v{};
      words >> v[0] >> v[1] >> v[2];
      EXPECT_TRUE(words) << line;
      mesh.vertices.push_back(v);
    } else if (key == "f") {
      Triangle t{};
      words >> t[0] >> t[1] >> t[2];
      EXPECT_TRUE(words) << line;
      for (auto& corner : t) --corner;
      mesh.triangles.push_back(t);
    } else {
      EXPECT_EQ(key, "#") << line;
    }
  }
  return mesh;
}

ParsedMesh parse_ply(const std::string& bytes) {
  ParsedMesh mesh;
  const std::size_t end = bytes.find("end_header\n");
  EXPECT_NE(end, std::string::npos);
  const std::string header = bytes.substr(0, end);
  std::size_t vertices = 0, faces = 0;
  std::istringstream lines(header);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string key, name;
    words >> key >> name;
    if (key == "element" && name == "vertex") words >> vertices;
    if (key == "element" && name == "face") words >> faces;
  }
  EXPECT_NE(header.find("property double x\nproperty double y\nproperty double z\n"), std::string::npos);
  EXPECT_NE(header.find("property list uchar int vertex_indices\n"), std::string::npos);
  std::size_t offset = end + 11;
  if (header.find("format ascii 1.0") != std::string::npos) {
    std::istringstream body(bytes.substr(offset));
    for (std::size_t i = 0; i < vertices; ++i) {
      std::array<double, 3> v{};
      body >> v[0] >> v[1] >> v[2];
      mesh.vertices.push_back(v);
    }
    for (std::size_t i = 0; i < faces; ++i) {
      Triangle t{};
      int corners = 0;
      body >> corners >> t[0] >> t[1] >> t[2];
      EXPECT_EQ(corners, 3);
      mesh.triangles.push_back(t);
    }
    EXPECT_TRUE(body);
    std::string rest;
    EXPECT_FALSE(body >> rest);
    return mesh;
  }
  EXPECT_NE(header.find("format binary_little_endian 1.0"), std::string::npos);
  EXPECT_EQ(bytes.size(), offset + vertices * 24 + faces * 13);
  for (std::size_t i = 0; i < vertices; ++i, offset += 24)
    mesh.vertices.push_back(
        {at<double>(bytes, offset), at<double>(bytes, offset + 8), at<double>(bytes, offset + 16)});
  for (std::size_t i = 0; i < faces; ++i, offset += 13) {
    EXPECT_EQ(at<std::uint8_t>(bytes, offset), 3);
    mesh.triangles.push_back({at<std::uint32_t>(bytes, offset + 1), at<std::uint32_t>(bytes, offset + 5),
                              at<std::uint32_t>(bytes, offset + 9)});
  }
  return mesh;
}

ParsedMesh parse_2dm(const std::string& text) {
  ParsedMesh mesh;
  EXPECT_TRUE(text.starts_with("MESH2D\n"));
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string key;
    std::size_t number = 0;
    words >> key >> number;
    if (key == "ND") {
      std::array<double, 3> v{};
      words >> v[0] >> v[1] >> v[2];
      mesh.vertices.push_back(v);
      EXPECT_EQ(number, mesh.vertices.size());
    } else if (key == "E3T") {
      Triangle t{};
      int material = 0;
      words >> t[0] >> t[1] >> t[2] >> material;
      for (auto& corner : t) --corner;
      mesh.triangles.push_back(t);
      EXPECT_EQ(number, mesh.triangles.size());
      EXPECT_EQ(material, 1);
    }
  }
  return mesh;
}

ParsedMesh parse_landxml(const std::string& text) {
  ParsedMesh mesh;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t begin = line.find('>');
    std::istringstream words(line.substr(begin == std::string::npos ? 0 : begin + 1));
    if (line.starts_with("<P id=\"")) {
      double northing = 0, easting = 0, z = 0;
      words >> northing >> easting >> z;
      mesh.vertices.push_back({easting, northing, z});
      EXPECT_EQ(std::stoul(line.substr(7)), mesh.vertices.size());
    } else if (line.starts_with("<F>") || line.starts_with("<F i=\"1\">")) {
      Triangle t{};
      words >> t[0] >> t[1] >> t[2];
      for (auto& corner : t) --corner;
      mesh.triangles.push_back(t);
      mesh.hidden += line.starts_with("<F>") ? 0 : 1;
    }
  }
  return mesh;
}

ParsedMesh parse_cityjson(const std::string& text) {
  ParsedMesh mesh;
  const Json city = Json::parse(text);
  EXPECT_EQ(city.at("type"), "CityJSON");
  EXPECT_EQ(city.at("version"), "1.1");
  const Json &scale = city.at("transform").at("scale"), &move = city.at("transform").at("translate");
  for (const Json& vertex : city.at("vertices")) {
    std::array<double, 3> v{};
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_TRUE(vertex.at(i).is_number_integer());
      v[i] = vertex.at(i).get<double>() * scale.at(i).get<double>() + move.at(i).get<double>();
    }
    mesh.vertices.push_back(v);
  }
  for (const auto& [name, object] : city.at("CityObjects").items()) {
    EXPECT_EQ(object.at("type"), "TINRelief");
    EXPECT_EQ(object.at("geometry").at(0).at("type"), "CompositeSurface");
    for (const Json& surface : object.at("geometry").at(0).at("boundaries")) {
      EXPECT_EQ(surface.size(), 1U);  // one ring
      mesh.triangles.push_back(surface.at(0).get<Triangle>());
    }
  }
  return mesh;
}

ParsedMesh parse_glb(const std::string& bytes) {
  ParsedMesh mesh;
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(at<std::uint32_t>(bytes, 4), 2U);
  EXPECT_EQ(at<std::uint32_t>(bytes, 8), bytes.size());
  const auto length = at<std::uint32_t>(bytes, 12);
  EXPECT_EQ(length % 4, 0U);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  const Json json = Json::parse(bytes.substr(20, length));
  const std::size_t binary = 20 + length + 8;
  EXPECT_EQ(bytes.substr(binary - 4, 4), std::string("BIN\0", 4));
  EXPECT_EQ(at<std::uint32_t>(bytes, binary - 8), json.at("buffers").at(0).at("byteLength"));
  EXPECT_EQ(bytes.size(), binary + json.at("buffers").at(0).at("byteLength").get<std::size_t>());
  const auto matrix = json.at("nodes").at(0).at("matrix").get<std::array<double, 16>>();
  const Json& positions = json.at("accessors").at(0);
  std::array<float, 3> low{1e30F, 1e30F, 1e30F}, high{-1e30F, -1e30F, -1e30F};
  for (std::size_t i = 0; i < positions.at("count").get<std::size_t>(); ++i) {
    std::array<double, 3> scene{matrix[12], matrix[13], matrix[14]};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto value = at<float>(bytes, binary + 12 * i + 4 * axis);
      low[axis] = std::min(low[axis], value);
      high[axis] = std::max(high[axis], value);
      for (std::size_t row = 0; row < 3; ++row) scene[row] += matrix[4 * axis + row] * double(value);
    }
    mesh.vertices.push_back({scene[0], -scene[2], scene[1]});  // y up becomes z up
  }
  const auto numbers = [&positions](const char* name) {
    return positions.at(name).get<std::array<float, 3>>();
  };
  EXPECT_EQ(numbers("min"), low);
  EXPECT_EQ(numbers("max"), high);
  if (json.at("accessors").size() < 2) return mesh;
  const auto start = binary + json.at("bufferViews").at(1).at("byteOffset").get<std::size_t>();
  for (std::size_t i = 0; i < json.at("accessors").at(1).at("count").get<std::size_t>() / 3; ++i) {
    mesh.triangles.push_back({at<std::uint32_t>(bytes, start + 12 * i),
                              at<std::uint32_t>(bytes, start + 12 * i + 4),
                              at<std::uint32_t>(bytes, start + 12 * i + 8)});
  }
  return mesh;
}

void expect_mesh_of(const ParsedMesh& parsed, const tin::terrain::Terrain& terrain, double across,
                    double up) {
  const auto vertices = terrain.vertices_by_id();
  ASSERT_EQ(parsed.vertices.size(), vertices.size());
  std::vector<std::uint32_t> number(terrain.mesh().vertex_slots());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    ASSERT_NEAR(parsed.vertices[i][0], terrain.frame().x.world(vertices[i].at.x), across);
    ASSERT_NEAR(parsed.vertices[i][1], terrain.frame().y.world(vertices[i].at.y), across);
    ASSERT_NEAR(parsed.vertices[i][2], vertices[i].z, up);
    number[terrain.slot_of(vertices[i].id)->value()] = static_cast<std::uint32_t>(i);
  }
  std::set<Triangle> expected, found;
  const auto& mesh = terrain.mesh();
  for (std::uint32_t slot = 0; slot < mesh.triangle_slots(); ++slot) {
    const tin::mesh::TriangleSlot t(slot);
    if (!mesh.is_alive(t) || mesh.is_infinite(t)) continue;
    expected.insert(smallest_first({number[mesh.vertex(t, 0).value()], number[mesh.vertex(t, 1).value()],
                                    number[mesh.vertex(t, 2).value()]}));
  }
  for (const Triangle& t : parsed.triangles) found.insert(smallest_first(t));
  EXPECT_EQ(found.size(), parsed.triangles.size());
  EXPECT_EQ(found, expected);
}

}  // namespace tests::formats
