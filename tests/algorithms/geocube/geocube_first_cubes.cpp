// First cubes of triangles as their vertices tell them.
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/geocube/glass_object.hpp"
#include "algorithms/scene/shapes/procedural.hpp"

namespace pellucid::geocube {
namespace {

TEST(GeocubeFirstCubes, EveryVertexTellsTheCubeOfItsTriangles) {
  const Mesh mesh = make_sphere(1.0F, 24);
  std::vector<std::uint8_t> cubes(mesh.triangles.size());
  for (std::size_t t = 0; t < cubes.size(); ++t)
    cubes[t] = static_cast<std::uint8_t>(t < cubes.size() / 2 ? 0 : t % 3);
  const GlassMesh drawn = with_first_cubes(mesh, cubes);
  ASSERT_EQ(drawn.triangles.size(), mesh.triangles.size());
  for (std::size_t t = 0; t < cubes.size(); ++t) {
    for (int c = 0; c < 3; ++c) {
      const GlassVertex& vertex = drawn.vertices[drawn.triangles[t][c]];
      EXPECT_EQ(vertex.first_cube, static_cast<float>(cubes[t]));
      EXPECT_EQ(vertex.position, mesh.positions[mesh.triangles[t][c]]);
      EXPECT_EQ(vertex.normal, mesh.normals[mesh.triangles[t][c]]);
    }
  }
  EXPECT_GT(drawn.vertices.size(), mesh.positions.size());
  EXPECT_LE(drawn.vertices.size(), 3 * mesh.positions.size());
}

TEST(GeocubeFirstCubes, OneCubeTakesNoFurtherVertices) {
  const Mesh mesh = make_sphere(1.0F, 12);
  const GlassMesh one = with_first_cubes(mesh, std::vector<std::uint8_t>(mesh.triangles.size(), 4));
  EXPECT_EQ(one.vertices.size(), mesh.positions.size());
  EXPECT_EQ(one.triangles, mesh.triangles);
  for (const glm::uvec3& t : one.triangles)
    EXPECT_EQ(one.vertices[t.x].first_cube, 4.0F);
  EXPECT_EQ(with_first_cubes(mesh, {}).vertices.size(), mesh.positions.size());
}

}  // namespace
}  // namespace pellucid::geocube
