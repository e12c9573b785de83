#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/scene/shapes/procedural.hpp"
#include "gl/error.hpp"

namespace pellucid {
namespace {

Scene forest(const ForestOptions& options) {
  Scene scene;
  add_forest(scene, options);
  return scene;
}

bool is_tree(const Instance& instance) {
  return instance.name.starts_with("tree_");
}

glm::vec3 place(const Instance& instance) {
  return glm::vec3(instance.to_world[3]);
}

TEST(ProceduralForest, HasItsTreesOnTheGroundAndOutsideTheClearing) {
  ForestOptions options;
  options.extent = {50, 40};
  options.trees = 217;
  options.clearing = {6, -3};
  options.clearing_radius = 5;
  const Scene scene = forest(options);
  int trees = 0;
  std::set<int> meshes;
  for (const Instance& instance : scene.instances) {
    if (!is_tree(instance)) continue;
    ++trees;
    meshes.insert(instance.mesh);
    const glm::vec3 p = place(instance);
    EXPECT_GT(glm::distance(glm::vec2(p.x, p.z), options.clearing), 5.0F);
    EXPECT_LE(std::abs(p.x), 25.0F);
    EXPECT_LE(std::abs(p.z), 20.0F);
    EXPECT_NEAR(p.y, forest_ground_height(options, p.x, p.z) - 0.05F, 1e-4F);
  }
  EXPECT_EQ(trees, 217);
  EXPECT_GE(meshes.size(), 8U) << "several kinds, near and far";
}

TEST(ProceduralForest, TrunksKeepADistance) {
  const Scene scene = forest({});
  std::vector<glm::vec3> places;
  for (const Instance& instance : scene.instances) {
    if (is_tree(instance)) places.push_back(place(instance));
  }
  float nearest = 1e9F;
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j)
      nearest = std::min(nearest, glm::distance(places[i], places[j]));
  }
  EXPECT_GT(nearest, 0.5F);
}

TEST(ProceduralForest, MeshesAreSound) {
  const Scene scene = forest({});
  std::size_t triangles = 0;
  for (const Instance& instance : scene.instances) {
    ASSERT_GE(instance.mesh, 0);
    ASSERT_LT(static_cast<std::size_t>(instance.mesh), scene.meshes.size());
    ASSERT_LT(static_cast<std::size_t>(instance.material), scene.materials.size());
    triangles += scene.meshes[static_cast<std::size_t>(instance.mesh)].triangles.size();
  }
  EXPECT_LT(triangles, 250000U) << "a software rasteriser draws it twice a frame";
  EXPECT_GT(triangles, 80000U);
  for (const Mesh& mesh : scene.meshes) {
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size()) << mesh.name;
    ASSERT_EQ(mesh.colors.size(), mesh.positions.size()) << mesh.name;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      ASSERT_TRUE(std::isfinite(mesh.positions[i].x + mesh.positions[i].y + mesh.positions[i].z)) << mesh.name;
      ASSERT_NEAR(glm::length(mesh.normals[i]), 1.0F, 1e-4F) << mesh.name;
      for (int c = 0; c < 3; ++c)
        ASSERT_TRUE(mesh.colors[i][c] >= 0.0F && mesh.colors[i][c] <= 0.8F) << mesh.name;
    }
    for (const auto& t : mesh.triangles) {
      ASSERT_LT(std::max({t.x, t.y, t.z}), mesh.positions.size()) << mesh.name;
    }
  }
}

TEST(ProceduralForest, GroundFollowsItsHeight) {
  ForestOptions options;
  options.relief_m = 2.0F;
  const Scene scene = forest(options);
  const Mesh& ground = scene.meshes[static_cast<std::size_t>(scene.instances.front().mesh)];
  EXPECT_EQ(scene.instances.front().name, "ground");
  float low = 0.0F, high = 0.0F;
  for (std::size_t i = 0; i < ground.positions.size(); ++i) {
    const glm::vec3 p = ground.positions[i];
    EXPECT_EQ(p.y, forest_ground_height(options, p.x, p.z));
    EXPECT_GT(ground.normals[i].y, 0.5F);
    low = std::min(low, p.y);
    high = std::max(high, p.y);
  }
  EXPECT_GT(high - low, 0.5F);
  EXPECT_LT(high - low, 2.5F);
  options.relief_m = 0.0F;
  EXPECT_EQ(forest_ground_height(options, 3.3F, -8.1F), 0.0F);
}

TEST(ProceduralForest, IsTheSameForASeed) {
  ForestOptions options;
  options.trees = 60;
  const Scene a = forest(options), b = forest(options);
  ASSERT_EQ(a.instances.size(), b.instances.size());
  for (std::size_t i = 0; i < a.instances.size(); ++i) {
    EXPECT_EQ(a.instances[i].to_world, b.instances[i].to_world);
    EXPECT_EQ(a.instances[i].mesh, b.instances[i].mesh);
    EXPECT_EQ(a.instances[i].tint, b.instances[i].tint);
  }
  for (std::size_t i = 0; i < a.meshes.size(); ++i)
    EXPECT_EQ(a.meshes[i].positions, b.meshes[i].positions);
  options.seed = 2;
  EXPECT_NE(forest(options).instances[1].to_world, a.instances[1].to_world);
}

TEST(ProceduralForest, NoTreesAndManyTrees) {
  ForestOptions options;
  options.trees = 0;
  EXPECT_EQ(forest(options).instances.size(), 1U);
  options.trees = 3000;
  options.extent = {20, 20};
  const Scene crowded = forest(options);
  EXPECT_EQ(std::count_if(crowded.instances.begin(), crowded.instances.end(), is_tree), 3000);
}

TEST(ProceduralForest, AClearingWithoutRoomIsAnError) {
  ForestOptions options;
  options.clearing_radius = 100.0F;
  Scene scene;
  EXPECT_THROW(add_forest(scene, options), InputError);
}

}  // namespace
}  // namespace pellucid
