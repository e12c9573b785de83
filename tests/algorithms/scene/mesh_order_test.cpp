#include "algorithms/scene/meshes/mesh_order.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace pellucid {
namespace {

constexpr unsigned kSide = 64;

// A grid of squares in the plane z = 0 whose vertices and triangles come in any order; the last vertex is in no
// triangle.
Mesh shuffled_grid() {
  std::mt19937 random(7);
  std::vector<unsigned> place((kSide + 1) * (kSide + 1));
  for (unsigned i = 0; i < place.size(); ++i)
    place[i] = i;
  std::shuffle(place.begin(), place.end(), random);
  Mesh mesh;
  mesh.positions.resize(place.size() + 1, glm::vec3(3.0F));
  mesh.normals.resize(place.size() + 1, glm::vec3(0, 0, 1));
  mesh.colors.resize(place.size() + 1);
  for (unsigned y = 0; y <= kSide; ++y) {
    for (unsigned x = 0; x <= kSide; ++x) {
      const unsigned at = place[y * (kSide + 1) + x];
      mesh.positions[at] = glm::vec3(x, y, 0);
      mesh.colors[at] = glm::vec3(x, y, 5);
    }
  }
  for (unsigned y = 0; y < kSide; ++y) {
    for (unsigned x = 0; x < kSide; ++x) {
      const unsigned i = y * (kSide + 1) + x;
      mesh.triangles.emplace_back(place[i], place[i + 1], place[i + kSide + 2]);
      mesh.triangles.emplace_back(place[i], place[i + kSide + 2], place[i + kSide + 1]);
    }
  }
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
  return mesh;
}

using Corners = std::array<std::array<float, 3>, 3>;

// Triangles by their corners' places, the smallest first: the same for every order that keeps the winding.
std::multiset<Corners> shape_of(const Mesh& mesh) {
  std::multiset<Corners> result;
  for (const glm::uvec3& t : mesh.triangles) {
    Corners corners{};
    for (std::size_t c = 0; c < 3; ++c) {
      const glm::vec3& p = mesh.positions[t[static_cast<int>(c)]];
      corners[c] = {p.x, p.y, p.z};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    result.insert(corners);
  }
  return result;
}

// Vertices transformed for each vertex used, with a cache that keeps the last 32.
double transforms_per_vertex(const Mesh& mesh) {
  std::vector<unsigned> cache;
  std::set<unsigned> used;
  std::size_t transforms = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    for (int c = 0; c < 3; ++c) {
      used.insert(t[c]);
      if (std::find(cache.begin(), cache.end(), t[c]) != cache.end()) continue;
      ++transforms;
      cache.push_back(t[c]);
      if (cache.size() > 32) cache.erase(cache.begin());
    }
  }
  return static_cast<double>(transforms) / static_cast<double>(used.size());
}

TEST(MeshOrder, KeepsTheShapeAndBringsNeighboursTogether) {
  Mesh mesh = shuffled_grid();
  const auto shape = shape_of(mesh);
  ASSERT_GT(transforms_per_vertex(mesh), 5.0);  // six triangles meet at a vertex
  order_by_place(mesh);
  EXPECT_EQ(shape_of(mesh), shape);
  // A row of squares that spans the cache would do with 2; Morton's curve turns back sooner.
  EXPECT_LT(transforms_per_vertex(mesh), 1.5);
  ASSERT_EQ(mesh.positions.size(), (kSide + 1) * (kSide + 1));
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  ASSERT_EQ(mesh.colors.size(), mesh.positions.size());
  EXPECT_TRUE(mesh.uvs.empty());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    EXPECT_EQ(glm::vec2(mesh.colors[i]), glm::vec2(mesh.positions[i]));
}

TEST(MeshOrder, VerticesAreNumberedByFirstUse) {
  Mesh mesh = shuffled_grid();
  order_by_place(mesh);
  unsigned next = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    for (int c = 0; c < 3; ++c) {
      ASSERT_LE(t[c], next);
      next = std::max(next, t[c] + 1);
    }
  }
  EXPECT_EQ(next, mesh.positions.size());
}

TEST(MeshOrder, NothingStaysNothing) {
  Mesh mesh;
  order_by_place(mesh);
  EXPECT_TRUE(mesh.triangles.empty());
  EXPECT_TRUE(mesh.positions.empty());
}

}  // namespace
}  // namespace pellucid
