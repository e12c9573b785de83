#include "algorithms/scene/shapes/bounds.hpp"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "algorithms/scene/shapes/procedural.hpp"

namespace pellucid {
namespace {

TEST(Bounds, OfAMeshInItsOwnCoordinates) {
  const Bounds box = mesh_bounds(make_box({2.0F, 4.0F, 6.0F}));
  EXPECT_EQ(box.min, glm::vec3(-1, -2, -3));
  EXPECT_EQ(box.max, glm::vec3(1, 2, 3));
  EXPECT_EQ(box.corner(0), box.min);
  EXPECT_EQ(box.corner(2), glm::vec3(-1, 2, -3));
  EXPECT_EQ(box.corner(7), box.max);
  EXPECT_EQ(mesh_bounds(Mesh{}).max, glm::vec3(0.0F)) << "without vertices a point at the origin";
}

TEST(Bounds, OfAScene) {
  Scene scene;
  EXPECT_EQ(world_bounds(scene).min, glm::vec3(0.0F));
  EXPECT_EQ(world_bounds(scene).max, glm::vec3(0.0F));
  // A mesh that nothing places does not count, nor one without vertices.
  scene.meshes = {make_box({2.0F, 4.0F, 6.0F}), make_box(glm::vec3(100.0F)), Mesh{}};
  scene.materials.emplace_back();
  const glm::mat4 aside = glm::translate(glm::mat4(1.0F), {10.0F, 20.0F, 30.0F});
  scene.instances.push_back({.name = "turned", .to_world = glm::rotate(aside, glm::radians(90.0F), {0, 0, 1})});
  scene.instances.push_back({.name = "nothing", .mesh = 2});
  EXPECT_LT(glm::length(world_bounds(scene).min - glm::vec3(8, 19, 27)), 1e-5F);
  EXPECT_LT(glm::length(world_bounds(scene).max - glm::vec3(12, 21, 33)), 1e-5F);
  scene.volume.emplace();
  scene.volume->to_world = glm::scale(glm::mat4(1.0F), glm::vec3(-5.0F, 1.0F, 1.0F));
  EXPECT_LT(glm::length(world_bounds(scene).min - glm::vec3(-5, 0, 0)), 1e-5F);
  EXPECT_LT(glm::length(world_bounds(scene).max - glm::vec3(12, 21, 33)), 1e-5F);
}

}  // namespace
}  // namespace pellucid
