// Solids out of what files hold: holes closed, triangles outward, Loop's subdivision, iso-surfaces.
#include "algorithms/scene/meshes/mesh_processing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/scene/shapes/procedural.hpp"
#include "tests/algorithms/scene/folder_test.hpp"
#include "tests/algorithms/scene/stored_voxels.hpp"

namespace pellucid {
namespace {

using Place = std::array<float, 3>;

std::array<Place, 3> corners(const Mesh& mesh, const glm::uvec3& t) {
  std::array<Place, 3> out;
  for (glm::length_t i = 0; i < 3; ++i) {
    const glm::vec3& p = mesh.positions[t[i]];
    out[static_cast<std::size_t>(i)] = {p.x, p.y, p.z};
  }
  return out;
}

// Edges, by place, that do not have exactly one triangle in each direction.
std::size_t open_edges(const Mesh& mesh) {
  std::map<std::pair<Place, Place>, int> directed;
  for (const glm::uvec3& t : mesh.triangles) {
    const auto c = corners(mesh, t);
    for (std::size_t i = 0; i < 3; ++i)
      ++directed[{c[i], c[(i + 1) % 3]}];
  }
  std::size_t open = 0;
  for (const auto& [edge, count] : directed) {
    const auto back = directed.find({edge.second, edge.first});
    open += count != 1 || back == directed.end() || back->second != 1 ? 1U : 0U;
  }
  return open;
}

// Positive when the triangles are counter-clockwise from outside.
double signed_volume(const Mesh& mesh) {
  double volume = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    volume += glm::dot(a, glm::cross(b, c)) / 6.0;
  }
  return volume;
}

TEST(MeshProcessing, ClosesHolesAndTurnsOutward) {
  Mesh mesh = make_sphere(1.0F, 32);
  const double whole = signed_volume(mesh);
  // Two holes, and the rest inside out.
  std::erase_if(mesh.triangles, [&](const glm::uvec3& t) {
    const glm::vec3 center = (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0F;
    return center.y > 0.9F || center.x < -0.95F;
  });
  for (glm::uvec3& t : mesh.triangles)
    std::swap(t.y, t.z);
  ASSERT_GT(open_edges(mesh), 8U);
  process_mesh(mesh, {.close_holes = true}, 60);
  EXPECT_EQ(open_edges(mesh), 0U);
  // The caps are flat: they cut off 2 % and less than 1 %.
  EXPECT_NEAR(signed_volume(mesh), whole, 0.04 * whole);
  EXPECT_LT(signed_volume(mesh), whole);
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
}

TEST(MeshProcessing, LoopSubdivisionQuadruplesAndStaysClosed) {
  Mesh mesh = make_box(glm::vec3(1.0F));
  process_mesh(mesh, {.subdivide = 3}, 180);
  EXPECT_EQ(mesh.triangles.size(), 12U * 64U);
  EXPECT_EQ(open_edges(mesh), 0U);
  // Loop's limit of a cube lies well within it, and is no smaller than the ball that touches its faces' middles
  // halfway.
  EXPECT_LT(signed_volume(mesh), 0.8);
  EXPECT_GT(signed_volume(mesh), 0.15);
}

TEST(MeshProcessing, RefusesWhatItCannotDo) {
  Mesh mesh = make_sphere(1.0F, 256);
  const std::string many = test::message_of([&] { process_mesh(mesh, {.subdivide = 5}, 60); });
  EXPECT_NE(many.find("at most 50000000"), std::string::npos) << many;

  Mesh fork;
  fork.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  fork.normals.assign(5, {0, 0, 1});
  fork.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  const std::string forked = test::message_of([&] { process_mesh(fork, {.subdivide = 1}, 60); });
  EXPECT_NE(forked.find("more than two triangles"), std::string::npos) << forked;
}

VolumeFile balls(int n, std::initializer_list<glm::dvec4> center_radius) {
  VolumeFile volume;
  std::vector<float> values;
  volume.size = glm::ivec3(n);
  volume.spacing = {1.0, 1.0, 2.0};
  for (int z = 0; z < n; ++z) {
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        double best = -1e3;
        for (const glm::dvec4& ball : center_radius)
          best = std::max(best, ball.w - glm::length(glm::dvec3(x, y, 2.0 * z) - glm::dvec3(ball)));
        values.push_back(static_cast<float>(best));
      }
    }
  }
  test::store(volume, std::move(values));
  return volume;
}

TEST(Isosurface, OfABallIsABall) {
  const VolumeFile volume = balls(32, {{14, 15, 30, 9}, {26, 26, 54, 2}});
  const Mesh mesh = isosurface(volume, {.level = 0.0, .refine = 1.5});
  EXPECT_EQ(open_edges(mesh), 0U);
  const double exact = 4.0 / 3.0 * std::numbers::pi * 9 * 9 * 9;
  EXPECT_NEAR(signed_volume(mesh), exact, 0.01 * exact) << "outward, and the smaller ball left out";
  // Interpolated between voxels 1 and 2 apart: the distance field is curved by 1/9 there.
  for (const glm::vec3& p : mesh.positions)
    EXPECT_NEAR(glm::length(glm::dvec3(p) - glm::dvec3(14, 15, 30)), 9.0, 0.06);
}

TEST(Isosurface, IsClosedAtTheBorder) {
  const Mesh mesh = isosurface(balls(16, {{0, 8, 16, 6}}), {.level = 0.0});
  EXPECT_EQ(open_edges(mesh), 0U);
  EXPECT_GT(signed_volume(mesh), 2.0 / 3.0 * std::numbers::pi * 216 * 0.95);
}

TEST(Isosurface, LevelOutsideTheDataIsRefused) {
  const std::string words = test::message_of([&] { isosurface(balls(8, {{4, 4, 8, 2}}), {.level = 9.0}); });
  EXPECT_NE(words.find("level 9 is not between"), std::string::npos) << words;
}

class MeshKeys : public test::FolderTest {
 protected:
  // A tetrahedron without its bottom, and a scene with a mesh of it.
  std::string scene_with(std::string_view keys) const {
    write("open.off", "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n");
    return write("scene.toml",
                 "title = \"t\"\n[views.v]\neye = [0, 0, 3]\ntarget = [0, 0, 0]\n[meshes.solid]\n" + std::string(keys))
        .string();
  }
};

TEST_F(MeshKeys, CloseAndSubdivide) {
  const Scene scene = load_scene(scene_with("file = \"open.off\"\nclose_holes = true\nsubdivide = 1\n"));
  EXPECT_EQ(scene.meshes.at(0).triangles.size(), 16U);
  EXPECT_EQ(open_edges(scene.meshes[0]), 0U);
  EXPECT_GT(signed_volume(scene.meshes[0]), 0.0);
}

TEST_F(MeshKeys, IsosurfaceOfAVolumeFile) {
  std::string raw;
  for (const double value : test::values_of(balls(24, {{11, 11, 22, 9}})))
    raw.append(reinterpret_cast<const char*>(&value), sizeof value);
  write("ball.raw", raw);
  write("ball.mhd",
        "ObjectType = Image\nNDims = 3\nDimSize = 24 24 24\nElementSpacing = 1 1 2\nElementType = MET_DOUBLE\n"
        "ElementDataFile = ball.raw\n");
  const Scene scene = load_scene(scene_with("file = \"ball.mhd\"\nisosurface = 0\nrefine = 2\nfit_m = 1\n"));
  EXPECT_NEAR(signed_volume(scene.meshes.at(0)), std::numbers::pi / 6.0, 0.02);

  const std::string level = test::message_of([&] { load_scene(scene_with("file = \"ball.mhd\"\nisosurface = 70\n")); });
  EXPECT_NE(level.find("scene.toml:7:14: level 70 is not between"), std::string::npos) << level;
  const std::string alone = test::message_of([&] { load_scene(scene_with("file = \"open.off\"\nrefine = 2\n")); });
  EXPECT_NE(alone.find("refine"), std::string::npos) << alone;
}

}  // namespace
}  // namespace pellucid
