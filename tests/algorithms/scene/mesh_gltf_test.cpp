#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/algorithms/scene/mesh_formats.hpp"

/// glTF, GLB and 3DS.
namespace pellucid {
namespace {

using nlohmann::json;

class GltfFiles : public test::MeshFormats {
 protected:
  /// 24 corners with normals, as exporters write a box: positions, normals, indices of 16 bits.
  static std::string buffer(bool quantized = false) {
    std::string positions, normals, indices;
    for (const std::vector<int>& side : test::kBoxSides) {
      const auto corner = [&](std::size_t i) { return test::kBoxCorners[static_cast<std::size_t>(side[i])]; };
      const glm::vec3 normal(glm::normalize(glm::cross(corner(1) - corner(0), corner(3) - corner(0))));
      for (std::size_t i = 0; i < 4; ++i) {
        for (int c = 0; c < 3; ++c) {
          if (quantized)
            append(positions, static_cast<std::int16_t>(std::lround(corner(i)[c] * 2 * 32767)));
          else
            append(positions, static_cast<float>(corner(i)[c]));
          append(normals, normal[c]);
        }
        if (quantized) append(positions, std::int16_t{0});  // to a stride of 8
      }
    }
    for (unsigned s = 0; s < 6; ++s)
      for (const unsigned i : {0U, 1U, 2U, 0U, 2U, 3U})
        append(indices, static_cast<std::uint16_t>(4 * s + i));
    return positions + normals + indices;
  }
  static json document(bool quantized = false) {
    const unsigned positions = quantized ? 192 : 288;
    json d =
        json::parse(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2}]}]})");
    d["buffers"] = json::array({json{{"uri", "box.bin"}, {"byteLength", positions + 288 + 72}}});
    d["bufferViews"] = {{{"buffer", 0}, {"byteLength", positions}},
                        {{"buffer", 0}, {"byteOffset", positions}, {"byteLength", 288}},
                        {{"buffer", 0}, {"byteOffset", positions + 288}, {"byteLength", 72}}};
    d["accessors"] = {{{"bufferView", 0}, {"componentType", quantized ? 5122 : 5126}, {"count", 24}, {"type", "VEC3"}},
                      {{"bufferView", 1}, {"componentType", 5126}, {"count", 24}, {"type", "VEC3"}},
                      {{"bufferView", 2}, {"componentType", 5123}, {"count", 36}, {"type", "SCALAR"}}};
    if (!quantized) return d;
    d["bufferViews"][0]["byteStride"] = 8;
    d["accessors"][0]["normalized"] = true;
    d["nodes"][0]["scale"] = {0.5, 0.5, 0.5};
    d["extensionsRequired"] = json::array({"KHR_mesh_quantization"});
    return d;
  }
  MeshFile expect_box_of(const json& d, double tolerance = 1e-6) { return expect_box("box.gltf", d.dump(), tolerance); }
  std::string refusal_of(const json& d) { return refusal("box.gltf", d.dump()); }
};

TEST_F(GltfFiles, BuffersInFilesInlineAndInTheContainer) {
  write("box.bin", buffer());
  const MeshFile plain = expect_box_of(document());
  EXPECT_EQ(plain.files, (std::vector<std::filesystem::path>{file("box.gltf"), file("box.bin")}));
  EXPECT_EQ(plain.mesh.positions.size(), 24U);
  // A URI is percent-encoded; what is not is taken as it stands.
  write("box data 10%.bin", buffer());
  json encoded = document();
  encoded["buffers"][0]["uri"] = "box%20data%2010%25.bin";
  expect_box_of(encoded);
  encoded["buffers"][0]["uri"] = "box data 10%.bin";
  expect_box_of(encoded);
  encoded["buffers"][0]["uri"] = "gone.bin";
  EXPECT_EQ(refusal_of(encoded), "its buffer '" + file("gone.bin").string() + "' is missing");
  encoded["buffers"][0]["uri"] = "https://example.org/box.bin";
  EXPECT_EQ(refusal_of(encoded), "its buffer 'https://example.org/box.bin' is no file beside it");

  json inner = document();
  inner["buffers"][0].erase("uri");
  std::string text = inner.dump(), bytes = buffer(), glb;
  while (text.size() % 4 != 0)
    text += ' ';
  append(glb, std::uint32_t{0x46546C67});
  append(glb, std::uint32_t{2});
  append(glb, static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + bytes.size()));
  append(glb, static_cast<std::uint32_t>(text.size()));
  append(glb, std::uint32_t{0x4E4F534A});
  glb += text;
  append(glb, static_cast<std::uint32_t>(bytes.size()));
  append(glb, std::uint32_t{0x004E4942});
  glb += bytes;
  expect_box("box.glb", glb);
  EXPECT_EQ(refusal("cut.glb", glb.substr(0, glb.size() - 4)),
            fmt::format("its header claims {} bytes; it has {}", glb.size(), glb.size() - 4));
}

TEST_F(GltfFiles, MirroredNodesTurnTheirTrianglesOver) {
  write("box.bin", buffer());
  for (const glm::dvec3& scale :
       {glm::dvec3(-1, 1, 1), glm::dvec3(1, -1, 1), glm::dvec3(-1, -1, -1), glm::dvec3(-1, -1, 1)}) {
    json d = document();
    d["nodes"][0]["scale"] = {scale.x, scale.y, scale.z};
    expect_box_of(d);
    d["meshes"][0]["primitives"][0]["attributes"].erase("NORMAL");
    expect_box_of(d);
  }
  // The mirror in a parent, as a matrix, beside another in the child.
  json nested = document();
  nested["nodes"] = json::parse(
      R"([{"children": [1], "matrix": [-1,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1]}, {"mesh": 0, "scale": [1, -1, 1]}])");
  const MeshFile moved = expect_box_of(nested);
  EXPECT_NEAR(moved.mesh.positions[0].x, 5.5F, 1e-6);
}

TEST_F(GltfFiles, QuantizedPositionsAreScaled) {
  write("box.bin", buffer(true));
  expect_box_of(document(true), 4e-5);
}

// Three copies of the box: as it is, mirrored and moved, and turned by a quarter about z, its quaternion in bytes.
TEST_F(GltfFiles, InstancesStandWhereTheirAttributesSay) {
  std::string instances;
  for (const float v :
       {0.0F, 0.0F, 0.0F, 3.0F, 0.0F, 0.0F, 0.0F, 5.0F, 0.0F, 1.0F, 1.0F, 1.0F, -1.0F, 1.0F, 1.0F, 1.0F, 2.0F, 1.0F})
    append(instances, v);
  for (const int v : {0, 0, 0, 127, 0, 0, 0, 127, 0, 0, 90, 90})
    append(instances, static_cast<std::int8_t>(v));
  write("box.bin", buffer() + instances);
  json d = document();
  d["buffers"][0]["byteLength"] = 648 + 84;
  for (const auto& [at, length] : {std::pair(648, 36), std::pair(684, 36), std::pair(720, 12)})
    d["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", at}, {"byteLength", length}});
  d["accessors"].push_back({{"bufferView", 3}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
  d["accessors"].push_back({{"bufferView", 4}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
  d["accessors"].push_back(
      {{"bufferView", 5}, {"componentType", 5120}, {"count", 3}, {"type", "VEC4"}, {"normalized", true}});
  d["extensionsRequired"] = json::array({"EXT_mesh_gpu_instancing"});
  json& attributes = d["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  attributes = {{"TRANSLATION", 3}, {"SCALE", 4}, {"ROTATION", 5}};
  const Mesh mesh = load_mesh_file(write("box.gltf", d.dump()), 60).mesh;
  ASSERT_EQ(mesh.triangles.size(), 36U);
  glm::dvec3 low(1e30), high(-1e30);
  double volume = 0;  // outward triangles alone make the three add up
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    volume += glm::dot(a, glm::cross(b, c)) / 6;
    for (const glm::dvec3& p : {a, b, c})
      low = glm::min(low, p), high = glm::max(high, p);
  }
  EXPECT_NEAR(volume, 0.24 * (1 + 1 + 2), 1e-6);
  // The third is 1 wide and, twice as long, 1.2 high; a quarter turn about z makes it 1.2 wide and 1 high.
  EXPECT_LT(glm::length(low - glm::dvec3(-0.6, -0.3, -0.2)), 1e-6) << low.x << ' ' << low.y << ' ' << low.z;
  EXPECT_LT(glm::length(high - glm::dvec3(3.5, 5.5, 0.2)), 1e-6) << high.x << ' ' << high.y << ' ' << high.z;

  attributes["SCALE"] = 0;
  EXPECT_EQ(refusal_of(d), "the attributes of EXT_mesh_gpu_instancing are of different lengths");
  attributes = json::object();
  EXPECT_EQ(refusal_of(d), "EXT_mesh_gpu_instancing has none of TRANSLATION, ROTATION and SCALE");
  d["accessors"].push_back({{"componentType", 5126}, {"count", 60000}, {"type", "VEC3"}, {"sparse", json::object()}});
  attributes["TRANSLATION"] = 6;
  EXPECT_EQ(refusal_of(d), "TRANSLATION of EXT_mesh_gpu_instancing has no data");
}

// The target is the box itself: a weight of 1 makes it twice as large, one of −0.5 half as large.
TEST_F(GltfFiles, MorphTargetsMoveVerticesByTheirWeights) {
  write("box.bin", buffer());
  json d = document();
  d["meshes"][0]["primitives"][0]["targets"] = json::parse(R"([{"NORMAL": 1}, {"POSITION": 0}])");
  expect_box_of(d);
  d["meshes"][0]["weights"] = {0.5, 1};
  d["nodes"][0]["scale"] = {0.5, 0.5, 0.5};
  expect_box_of(d);
  d["nodes"][0]["weights"] = {0, -0.5};
  d["nodes"][0]["scale"] = {2, 2, 2};
  expect_box_of(d);
  d["meshes"][0]["primitives"][0]["targets"][1]["POSITION"] = 9;
  EXPECT_EQ(refusal_of(d), "POSITION names accessors[9], of which there are 3");
}

TEST_F(GltfFiles, StripsFansAndSparseAccessors) {
  const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0, 9, 9, 9};
  std::string bytes(reinterpret_cast<const char*>(positions), sizeof positions);
  append(bytes, std::uint16_t{3});
  bytes += std::string(2, '\0');
  write("s.bin", bytes);
  json d = json::parse(R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 5}]}], "buffers": [{"uri": "s.bin", "byteLength": 76}],
    "bufferViews": [{"buffer": 0, "byteLength": 60}, {"buffer": 0, "byteOffset": 72, "byteLength": 2}, {"buffer": 0, "byteOffset": 60, "byteLength": 12}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3"}]})");
  const auto area = [&] {
    const Mesh mesh = load_mesh_file(write("s.gltf", d.dump()), 60).mesh;
    double sum = 0;
    for (const glm::uvec3& t : mesh.triangles)
      sum += glm::cross(glm::dvec3(mesh.positions[t.y] - mesh.positions[t.x]),
                        glm::dvec3(mesh.positions[t.z] - mesh.positions[t.x]))
                 .z /
             2;
    return std::pair(mesh.triangles.size(), sum);
  };
  EXPECT_EQ(area(), std::pair(std::size_t{3}, 1.5)) << "all turned the same way";
  d["meshes"][0]["primitives"][0]["mode"] = 6;
  EXPECT_EQ(area().first, 3U);
  d["meshes"][0]["primitives"][0]["mode"] = 1;
  EXPECT_THROW(area(), InputError) << "lines alone";
  d["meshes"][0]["primitives"][0]["mode"] = 5;
  d["accessors"][0]["sparse"] =
      json::parse(R"({"count": 1, "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 2}})");
  EXPECT_EQ(area().first, 3U);
  EXPECT_GT(std::abs(area().second), 2) << "a corner is at 9 9 9";
}

TEST_F(GltfFiles, WhatIsNotUnderstoodOrNotThereIsRefused) {
  write("box.bin", buffer());
  json draco = document();
  draco["extensionsRequired"] = json::array({"KHR_materials_unlit", "KHR_draco_mesh_compression"});
  EXPECT_EQ(refusal_of(draco), "it requires the extension KHR_draco_mesh_compression, which is not supported");
  json compressed = document();
  compressed["accessors"][0].erase("bufferView");
  EXPECT_EQ(refusal_of(compressed), "the accessor of POSITION has no data (compressed data are not read)");
  json loop = document();
  loop["nodes"][0]["children"] = json::array({0});
  EXPECT_EQ(refusal_of(loop), "node 0 has two parents");
  json beyond = document();
  beyond["accessors"][2]["count"] = 39;
  EXPECT_EQ(refusal_of(beyond), "the accessor of indices has 39 elements, more than its 72 bytes hold");
  json short_file = document();
  short_file["buffers"][0]["byteLength"] = 649;
  EXPECT_EQ(refusal_of(short_file), "its buffer '" + file("box.bin").string() + "' has 648 bytes; 649 are claimed");
  json other = document();
  other["nodes"][0]["mesh"] = 4;
  EXPECT_EQ(refusal_of(other), "a node names meshes[4], of which there are 1");
  json old = document();
  old["asset"]["version"] = "1.0";
  EXPECT_EQ(refusal_of(old), "glTF 1.0 is not read; 2.0 is");
  json colored = document();
  colored["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = 1;
  EXPECT_EQ(refusal_of(colored), "vertex 0 has a colour of -1, out of [0, 1]");
  EXPECT_EQ(refusal("box.gltf", "{\"asset\": {").substr(0, 22), "its JSON is malformed:");
}

// ---- 3DS ----

std::string chunk(std::uint16_t number, const std::string& content) {
  const auto length = static_cast<std::uint32_t>(6 + content.size());
  return std::string(reinterpret_cast<const char*>(&number), 2) +
         std::string(reinterpret_cast<const char*>(&length), 4) + content;
}

class Files3ds : public test::MeshFormats {
 protected:
  /// Its z axis points up: our (x, y, z) is its (x, −z, y).
  static std::string mesh(bool grouped, unsigned corner = 0) {
    std::string vertices, faces, groups;
    append(vertices, std::uint16_t{8});
    for (const glm::dvec3& p : test::kBoxCorners)
      for (const double v : {p.x, -p.z, p.y})
        append(vertices, static_cast<float>(v));
    append(faces, std::uint16_t{12});
    for (const std::vector<int>& s : test::kBoxSides) {
      for (const std::size_t second : {1U, 2U}) {
        for (const int v : {s[0], s[second], s[second + 1]})
          append(faces, static_cast<std::uint16_t>(static_cast<unsigned>(v) + corner));
        append(faces, std::uint16_t{7});
        append(groups, std::uint32_t{1U << (&s - test::kBoxSides.data())});
      }
    }
    if (grouped) faces += chunk(0x4150, groups);
    return chunk(0x4000, std::string("box\0", 4) + chunk(0x4100, chunk(0x4110, vertices) + chunk(0x4120, faces)));
  }
};

TEST_F(Files3ds, MeshesAreReadWithTheirSmoothingGroups) {
  expect_box("a.3ds", chunk(0x4D4D, chunk(2, "abcd") + chunk(0x3D3D, mesh(false))));
  expect_box("a.3ds", chunk(0x4D4D, chunk(0x3D3D, mesh(true))));
  // Groups part what the crease angle would have joined.
  const auto grouped = write("g.3ds", chunk(0x4D4D, chunk(0x3D3D, mesh(true)))),
             plain = write("p.3ds", chunk(0x4D4D, chunk(0x3D3D, mesh(false))));
  EXPECT_EQ(load_mesh_file(grouped, 180).mesh.positions.size(), 24U);
  EXPECT_EQ(load_mesh_file(plain, 180).mesh.positions.size(), 8U);
}

TEST_F(Files3ds, DamagedFilesAreRefused) {
  const std::string whole = chunk(0x4D4D, chunk(0x3D3D, mesh(true)));
  for (std::size_t keep = 1; keep < whole.size(); keep += 7)
    EXPECT_NE(refusal("a.3ds", whole.substr(0, keep)), "") << keep;
  EXPECT_EQ(refusal("a.3ds", chunk(0x4D4D, chunk(0x3D3D, mesh(false, 1)))), "a face names vertex 8 of 8");
  const std::string node = chunk(0xB002, chunk(0xB010, std::string("box\0......", 10)));
  EXPECT_EQ(refusal("a.3ds", chunk(0x4D4D, chunk(0x3D3D, mesh(false)) + chunk(0xB000, node + node))),
            "its keyframes place the object 'box' 2 times; one is read");
}

}  // namespace
}  // namespace pellucid
