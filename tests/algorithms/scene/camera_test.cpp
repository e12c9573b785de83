#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "algorithms/scene/scene.hpp"
#include "tests/algorithms/scene/folder_test.hpp"
#include "tests/expect_near.hpp"

namespace pellucid {
namespace {

using test::expect_near;

TEST(Camera, LooksAlongMinusZInItsOwnSpace) {
  Camera camera;
  camera.view.eye = {0, 0, 5};
  const glm::vec4 target = camera.world_to_view() * glm::vec4(0, 0, 0, 1);
  expect_near(glm::dvec3(target), {0, 0, -5}, 1e-6);
  expect_near(camera.ray_direction(360, 270), {0, 0, -1}, 1e-12);
}

TEST(Camera, PixelsCountFromTheTopLeft) {
  Camera camera;  // 720×540, 45° high, from +z towards the origin
  const double t = std::tan(std::numbers::pi / 8);
  expect_near(camera.ray_direction(0, 0), glm::normalize(glm::dvec3(-t * 4 / 3, t, -1)), 1e-12);
  expect_near(camera.ray_direction(720, 540), glm::normalize(glm::dvec3(t * 4 / 3, -t, -1)), 1e-12);
}

TEST(Camera, NearAndFarPlanesMapToMinusOneAndOne) {
  Camera camera;
  camera.view.near_m = 0.5F;
  camera.view.far_m = 20;
  const auto depth = [&](float z) {
    const glm::vec4 clip = camera.projection() * glm::vec4(0, 0, z, 1);
    return clip.z / clip.w;
  };
  EXPECT_NEAR(depth(-0.5F), -1, 1e-5);
  EXPECT_NEAR(depth(-20), 1, 1e-5);
}

TEST(Camera, RaysAgreeWithProjection) {
  for (const glm::vec3 up : {glm::vec3(0, 1, 0), glm::vec3(0.3F, 0.2F, 0.9F)}) {
    Camera camera;
    camera.view.eye = {0.7F, 1.1F, 1.9F};
    camera.view.target = {-0.4F, 0.3F, -0.2F};
    camera.view.up = up;
    camera.view.fov_y_deg = 61;
    camera.view.near_m = 0.1F;
    camera.view.far_m = 10;
    camera.width = 321;
    camera.height = 97;
    const glm::dmat4 to_clip = glm::dmat4(camera.projection()) * glm::dmat4(camera.world_to_view());
    for (const double x : {0.0, 0.5, 160.5, 320.5, 321.0}) {
      for (const double y : {0.0, 13.5, 48.5, 97.0}) {
        const glm::dvec3 point = glm::dvec3(camera.view.eye) + 3.0 * camera.ray_direction(x, y);
        const glm::dvec4 clip = to_clip * glm::dvec4(point, 1.0);
        EXPECT_NEAR(clip.x / clip.w, 2 * x / camera.width - 1, 1e-6);
        EXPECT_NEAR(clip.y / clip.w, 1 - 2 * y / camera.height, 1e-6);
      }
    }
  }
}

TEST(Environment, GradientIsLinearInHeight) {
  Environment environment;
  environment.zenith = {1, 0, 0};
  environment.horizon = {0, 1, 0};
  environment.ground = {0, 0, 1};
  environment.scale = 2;
  expect_near(environment.radiance({0, 1, 0}), {2, 0, 0}, 1e-6);
  expect_near(environment.radiance({1, 0, 0}), {0, 2, 0}, 1e-6);
  expect_near(environment.radiance({0, -1, 0}), {0, 0, 2}, 1e-6);
  expect_near(environment.radiance({0.8F, 0.6F, 0}), {1.2, 0.8, 0}, 1e-6);
}

TEST(Environment, LatLongImageHasMinusZInTheMiddleAndUpInRowZero) {
  Environment environment;
  Image image(8, 4, 3);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 8; ++x) {
      image.at(x, y)[0] = static_cast<float>(x);
      image.at(x, y)[1] = static_cast<float>(y);
    }
  }
  environment.image = image;
  environment.scale = 10;
  const auto at = [&](double u, double v) {  // the inverse mapping
    const double phi = (u - 0.5) * 2 * std::numbers::pi;
    const double theta = v * std::numbers::pi;
    return environment.radiance(
        glm::vec3(std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi)));
  };
  expect_near(at(3.5 / 8, 1.5 / 4), {30, 10, 0}, 1e-3);
  expect_near(at(6.0 / 8, 2.0 / 4), {55, 15, 0}, 1e-3);  // +x, on the horizon
  expect_near(environment.radiance({1, 0, 0}), {55, 15, 0}, 1e-3);
  expect_near(environment.radiance({0, 0, -1}), {35, 15, 0}, 1e-3);
  expect_near(environment.radiance({0, 0, 1}), {35, 15, 0}, 1e-3);  // the seam: between columns 7 and 0
  EXPECT_NEAR(environment.radiance({0, 1, 0}).y, 0, 1e-3);
  EXPECT_NEAR(environment.radiance({0, -1, 0}).y, 30, 1e-3);
}

TEST(Volume, VoxelSpacingIsMeasuredInTheWorld) {
  Volume volume;
  volume.size = {10, 20, 40};
  volume.to_world =
      glm::mat4(glm::vec4(0, 2, 0, 0), glm::vec4(0, 0, 4, 0), glm::vec4(8, 0, 0, 0), glm::vec4(1, 1, 1, 1));
  expect_near(volume.voxel_spacing_m(), {0.2, 0.2, 0.2}, 1e-6);
}

TEST(Scene, FindsViewsByName) {
  Scene scene;
  scene.name = "s";
  EXPECT_THROW(scene.find_view(""), InputError);
  scene.views.resize(2);
  scene.views[0].name = "front";
  scene.views[1].name = "inside";
  EXPECT_EQ(scene.find_view("").name, "front");
  EXPECT_EQ(scene.find_view("inside").name, "inside");
  EXPECT_EQ(test::message_of([&] { scene.find_view("inisde"); }),
            "unknown view 'inisde' of scene 's'; did you mean 'inside'?");
  EXPECT_EQ(test::message_of([&] { scene.find_view("overhead"); }),
            "unknown view 'overhead' of scene 's'; it has front, inside");
}

}  // namespace
}  // namespace pellucid
