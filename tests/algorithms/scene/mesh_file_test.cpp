#include "algorithms/scene/meshes/mesh_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "tests/algorithms/scene/folder_test.hpp"

namespace pellucid {
namespace {

using test::message_of;

class MeshFileTest : public test::FolderTest {
 protected:
  std::string refusal(std::string_view name) { return "cannot read mesh '" + file(name).string() + "': "; }
};

constexpr std::string_view kTetrahedronOff = R"(OFF
# a comment
4 4 0
0 0 0
1 0 0
0 1 0
0 0 1
3 0 2 1
3 0 1 3
3 0 3 2
3 1 2 3
)";

void expect_unit_normals(const Mesh& mesh) {
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  for (const glm::vec3& n : mesh.normals)
    EXPECT_NEAR(glm::length(n), 1, 1e-5);
}

TEST_F(MeshFileTest, OffIsReadWithFlatOrSmoothNormals) {
  const auto path = write("t.off", kTetrahedronOff);
  const Mesh flat = load_mesh_file(path, 10).mesh;
  EXPECT_EQ(flat.triangles.size(), 4U);
  EXPECT_EQ(flat.positions.size(), 12U) << "each corner has three normals";
  expect_unit_normals(flat);
  for (const glm::uvec3& t : flat.triangles) {
    const glm::vec3 n = glm::normalize(
        glm::cross(flat.positions[t.y] - flat.positions[t.x], flat.positions[t.z] - flat.positions[t.x]));
    EXPECT_NEAR(glm::dot(n, flat.normals[t.x]), 1, 1e-5);
  }
  const Mesh smooth = load_mesh_file(path, 175).mesh;
  EXPECT_EQ(smooth.positions.size(), 4U);
  expect_unit_normals(smooth);
}

TEST_F(MeshFileTest, ObjWithNormalsTextureCoordinatesAndQuads) {
  const auto path = write("q.obj", R"(mtllib q.mtl
v 0 0 0
v 2 0 0
v 2 3 0
v 0 3 0
vt 0 0
vt 1 0
vt 1 1
vt 0 1
vn 0 0 1
usemtl paint
f 1/1/1 2/2/1 3/3/1 4/4/1
)");
  write("q.mtl", "newmtl paint\nKd 1 0 0\n");
  const MeshFile read = load_mesh_file(path, 60);
  EXPECT_EQ(read.mesh.triangles.size(), 2U);
  EXPECT_EQ(read.mesh.uvs.size(), read.mesh.positions.size());
  EXPECT_EQ(*std::max_element(read.mesh.uvs.begin(), read.mesh.uvs.end(),
                              [](const glm::vec2& a, const glm::vec2& b) { return a.x + a.y < b.x + b.y; }),
            glm::vec2(1, 1));
  for (const glm::vec3& n : read.mesh.normals)
    EXPECT_EQ(n, glm::vec3(0, 0, 1));
  EXPECT_NE(std::find(read.files.begin(), read.files.end(), file("q.mtl")), read.files.end());
}

TEST_F(MeshFileTest, PlyWithColours) {
  const auto path = write("c.ply", R"(ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
property uchar red
property uchar green
property uchar blue
element face 1
property list uchar int vertex_indices
end_header
0 0 0 255 0 0
1 0 0 0 255 0
0 1 0 0 0 255
3 0 1 2
)");
  const Mesh mesh = load_mesh_file(path, 60).mesh;
  ASSERT_EQ(mesh.triangles.size(), 1U);
  ASSERT_EQ(mesh.colors.size(), 3U);
  glm::vec3 sum(0.0F);
  for (const glm::vec3& c : mesh.colors)
    sum += c;
  EXPECT_EQ(sum, glm::vec3(1, 1, 1));
}

TEST_F(MeshFileTest, GltfNodesAreAppliedAndTheBufferIsNoted) {
  const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  write("g.bin", std::string_view(reinterpret_cast<const char*>(positions), sizeof positions));
  const auto path = write("g.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [{"mesh": 0, "translation": [10, 0, 0], "scale": [2, 2, 2]}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
"buffers": [{"uri": "g.bin", "byteLength": 36}],
"bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}]})");
  const MeshFile read = load_mesh_file(path, 60);
  ASSERT_EQ(read.mesh.positions.size(), 3U);
  EXPECT_EQ(read.mesh.positions[0], glm::vec3(10, 0, 0));
  EXPECT_EQ(read.mesh.positions[1], glm::vec3(12, 0, 0));
  EXPECT_EQ(read.mesh.positions[2], glm::vec3(10, 2, 0));
  EXPECT_NEAR(read.mesh.normals[0].z, 1, 1e-6);
  EXPECT_NE(std::find_if(read.files.begin(), read.files.end(), [](const auto& f) { return f.filename() == "g.bin"; }),
            read.files.end());
}

TEST_F(MeshFileTest, FitScalesAndCentres) {
  Mesh mesh = load_mesh_file(write("t.off", kTetrahedronOff), 60).mesh;
  fit_mesh(mesh, 4);
  for (const glm::vec3& p : mesh.positions) {
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(std::abs(p[axis]), 2, 1e-5);
  }
}

TEST_F(MeshFileTest, EmptyMissingOrUnknownFilesAreRefused) {
  EXPECT_EQ(message_of([&] { load_mesh_file(file("none.obj"), 60); }),
            refusal("none.obj") + "No such file or directory");
  EXPECT_EQ(message_of([&] { load_mesh_file(write("e.obj", ""), 60); }), refusal("e.obj") + "the file is empty");
  EXPECT_EQ(message_of([&] { load_mesh_file(write("m.stl", "x"), 60); }),
            refusal("m.stl") + "'.stl' is not one of .obj, .ply, .off, .gltf, .glb, .3ds");
  EXPECT_THROW(load_mesh_file(write("p.obj", "v 0 0 0\nv 1 0 0\n"), 60), InputError);
  EXPECT_THROW(load_mesh_file(write("p.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n"), 60), InputError);
}

TEST_F(MeshFileTest, HeadersThatClaimTooMuchAreRefusedBeforeReading) {
  EXPECT_EQ(message_of([&] { load_mesh_file(write("b.off", "OFF\n9 4000000000 0\n0 0 0\n"), 60); }),
            refusal("b.off") + "9 vertices and 4000000000 faces; at most 50000000 triangles are read");
  EXPECT_EQ(message_of([&] { load_mesh_file(write("b.off", "OFF 1000000 5 0\n0 0 0\n"), 60); }),
            refusal("b.off") + "its header claims 1000000 vertices and 5 faces, more than 22 bytes can hold");
  EXPECT_EQ(message_of([&] {
              load_mesh_file(write("b.ply",
                                   "ply\nformat ascii 1.0\nelement vertex 40000000\nproperty float x\n"
                                   "element face 1\nend_header\n"),
                             60);
            }),
            refusal("b.ply") + "its header claims 40000000 vertices and 1 faces, more than 88 bytes can hold");
  EXPECT_EQ(message_of([&] { load_mesh_file(write("b.off", "OFF\nmany\n"), 60); }),
            refusal("b.off") + "malformed OFF header");
}

TEST_F(MeshFileTest, DamagedFilesAreRefused) {
  EXPECT_EQ(message_of([&] { load_mesh_file(write("i.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n"), 60); }),
            refusal("i.off") + "face 0 names a vertex that does not exist");
  EXPECT_EQ(message_of([&] { load_mesh_file(write("c.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), 60); }),
            refusal("c.off") + "it ends at face 1 of 2");
  EXPECT_THROW(load_mesh_file(write("i.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), 60), InputError);
  EXPECT_THROW(load_mesh_file(write("i.ply",
                                    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                                    "property float y\nproperty float z\nelement face 1\n"
                                    "property list uchar int vertex_indices\nend_header\n"
                                    "0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n"),
                              60),
               InputError);
  EXPECT_THROW(load_mesh_file(write("n.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), 60), InputError);
  EXPECT_THROW(load_mesh_file(write("g.gltf", "{\"asset\": {"), 60), InputError);
  EXPECT_THROW(load_mesh_file(write("g.glb", "glTF\x02"), 60), InputError);
  EXPECT_THROW(load_mesh_file(write("p.ply",
                                    "ply\nformat binary_little_endian 1.0\nelement vertex 3\n"
                                    "property float x\nproperty float y\nproperty float z\nelement face 1\n"
                                    "property list uchar int vertex_indices\nend_header\nabc"),
                              60),
               InputError);
}

}  // namespace
}  // namespace pellucid
