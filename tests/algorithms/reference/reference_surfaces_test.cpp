#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "algorithms/reference/reference.hpp"
#include "algorithms/reference/shading.hpp"
#include "algorithms/scene/shapes/procedural.hpp"

namespace pellucid {
namespace {

using std::numbers::pi;

Scene scene_of(Mesh mesh, const glm::mat4& to_world, const glm::vec3& albedo = glm::vec3(0.5F)) {
  Scene scene;
  scene.meshes.push_back(std::move(mesh));
  scene.materials.push_back({"m", albedo, glm::vec3(0.0F)});
  scene.instances.push_back({"i", 0, 0, to_world, glm::vec3(1.0F)});
  return scene;
}

Camera camera_at(const glm::vec3& eye, const glm::vec3& target, int size, const glm::vec3& up = {0, 1, 0}) {
  Camera camera;
  camera.view.eye = eye;
  camera.view.target = target;
  camera.view.up = up;
  camera.width = camera.height = size;
  return camera;
}

// Distance to the sphere about `centre`, infinite where it is missed.
double sphere_distance(const glm::dvec3& o, const glm::dvec3& d, const glm::dvec3& centre, double radius) {
  const double b = glm::dot(o - centre, d), c = glm::dot(o - centre, o - centre) - radius * radius;
  const double square = b * b - c;
  return square < 0 ? std::numeric_limits<double>::infinity() : -b - std::sqrt(square);
}

double distance_at(const SurfaceLayer& layer, int x, int y) {
  return layer.distance_m[static_cast<std::size_t>(y * layer.radiance.width + x)];
}

TEST(ReferenceSurfaces, SphereDistancesLieWithinTheFacets) {
  const int segments = 256;
  Scene scene = scene_of(make_sphere(1.5F, segments), glm::translate(glm::mat4(1.0F), {0.3F, -0.2F, -4.0F}));
  scene.environment.horizon = scene.environment.zenith = scene.environment.ground = {0.1F, 0.2F, 0.3F};
  const Camera camera = camera_at({0, 0, 0}, {0.3F, -0.2F, -4.0F}, 48);
  const SurfaceLayer layer = trace_surfaces(scene, camera);
  const glm::dvec3 centre(0.3F, -0.2F, -4.0F);
  // A facet lies at most the sagitta below the sphere, in both directions together.
  const double sagitta = 2.0 * 1.5 * (1.0 - std::cos(pi / segments));
  int hits = 0, misses = 0;
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 48; ++x) {
      const glm::dvec3 d = camera.ray_direction(x + 0.5, y + 0.5);
      const double outer = sphere_distance(glm::dvec3(0), d, centre, 1.5);
      const double inner = sphere_distance(glm::dvec3(0), d, centre, 1.5 - sagitta);
      const double t = distance_at(layer, x, y);
      if (std::isinf(outer)) {
        ASSERT_TRUE(std::isinf(t));
        EXPECT_FLOAT_EQ(layer.radiance.at(x, y)[2], 0.3F);
        ++misses;
      } else if (!std::isinf(inner)) {
        ASSERT_GE(t, outer - 1e-6);
        ASSERT_LE(t, inner + 1e-6);
        ++hits;
      }
    }
  }
  EXPECT_GT(hits, 500);
  EXPECT_GT(misses, 100);
}

TEST(ReferenceSurfaces, PlaneDistancesAreExact) {
  const Scene scene = scene_of(make_plane({100, 100}, 3), glm::mat4(1.0F));
  const Camera camera = camera_at({1, 2, 5}, {0, 0, 0}, 32);
  const SurfaceLayer layer = trace_surfaces(scene, camera);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      const glm::dvec3 d = camera.ray_direction(x + 0.5, y + 0.5);
      EXPECT_NEAR(distance_at(layer, x, y), -2.0 / d.y, 1e-9 * distance_at(layer, x, y));
    }
  }
}

TEST(ReferenceSurfaces, InstancesAreTransformed) {
  // The plane y = 0, stretched, turned about an axis and moved: a general plane.
  glm::mat4 to_world = glm::translate(glm::mat4(1.0F), {0.5F, 1.0F, -6.0F});
  to_world = glm::rotate(to_world, 1.2F, glm::normalize(glm::vec3(1.0F, 0.2F, 0.1F)));
  to_world = glm::scale(to_world, {40.0F, 3.0F, 30.0F});
  const Scene scene = scene_of(make_plane({1, 1}, 2), to_world);
  const Camera camera = camera_at({0, 0, 0}, {0, 0, -1}, 24);
  const SurfaceLayer layer = trace_surfaces(scene, camera);
  const glm::dmat4 m(to_world);
  const glm::dvec3 p(m[3]), n = glm::cross(glm::dvec3(m[2]), glm::dvec3(m[0]));
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x) {
      const glm::dvec3 d = camera.ray_direction(x + 0.5, y + 0.5);
      EXPECT_NEAR(distance_at(layer, x, y), glm::dot(p, n) / glm::dot(d, n), 1e-5);
    }
  }
}

TEST(ReferenceSurfaces, NormalsOfStretchedInstancesStayPerpendicular) {
  // A sphere flattened to an ellipsoid, lit along +y and seen from there: cos θ = n.y.
  const glm::vec3 axes(2.0F, 0.5F, 1.0F);
  Scene scene = scene_of(make_sphere(1.0F, 512), glm::scale(glm::mat4(1.0F), axes), glm::vec3(1.0F));
  scene.lights.push_back({.name = "sun", .direction = {0, -1, 0}, .intensity = glm::vec3(1.0F)});
  const Camera camera = camera_at({0, 6, 0}, {0, 0, 0}, 21, {0, 0, -1});
  const SurfaceLayer layer = trace_surfaces(scene, camera);
  int hits = 0;
  for (int y = 0; y < 21; ++y) {
    for (int x = 0; x < 21; ++x) {
      const double t = distance_at(layer, x, y);
      if (std::isinf(t)) continue;
      const glm::dvec3 p = glm::dvec3(0, 6, 0) + t * camera.ray_direction(x + 0.5, y + 0.5);
      const glm::dvec3 n = glm::normalize(p / (glm::dvec3(axes) * glm::dvec3(axes)));
      if (n.y < 0.2) continue;
      EXPECT_NEAR(static_cast<double>(layer.radiance.at(x, y)[0]), n.y / pi, 2e-3);
      ++hits;
    }
  }
  EXPECT_GT(hits, 30);
}

TEST(ReferenceSurfaces, ClippingPlanesAreAtViewDepth) {
  Scene scene = scene_of(make_plane({400, 400}, 1), glm::rotate(glm::mat4(1.0F), 0.5F * glm::pi<float>(), {1, 0, 0}));
  Camera camera = camera_at({0, 0, 5}, {0, 0, 0}, 16);
  camera.view.near_m = 4.99F;
  camera.view.far_m = 5.01F;
  for (const double d : trace_surfaces(scene, camera).distance_m)
    EXPECT_TRUE(std::isfinite(d));
  camera.view.near_m = 5.01F;
  camera.view.far_m = 9.0F;
  for (const double d : trace_surfaces(scene, camera).distance_m)
    EXPECT_TRUE(std::isinf(d));
  camera.view.near_m = 1.0F;
  camera.view.far_m = 4.99F;
  for (const double d : trace_surfaces(scene, camera).distance_m)
    EXPECT_TRUE(std::isinf(d));
}

TEST(ReferenceSurfaces, AnEmptySceneIsItsEnvironment) {
  Scene scene;
  scene.environment.zenith = {0, 0, 1};
  const Camera camera = camera_at({0, 0, 0}, {0, 1, 0}, 3, {0, 0, 1});
  const SurfaceLayer layer = trace_surfaces(scene, camera);
  EXPECT_FLOAT_EQ(layer.radiance.at(1, 1)[2], 1.0F);
  EXPECT_TRUE(std::isinf(distance_at(layer, 1, 1)));
}

// ---- shading ----

TEST(ReferenceShading, MultipliesAlbedoVertexColourAndTintAndAddsEmission) {
  Scene scene = scene_of(make_plane({10, 10}, 1), glm::mat4(1.0F), {0.5F, 0.25F, 1.0F});
  scene.meshes[0].colors.assign(4, {0.5F, 1.0F, 0.75F});
  scene.instances[0].tint = {1.0F, 0.5F, 0.5F};
  scene.materials[0].emission = {0.0F, 0.0F, 2.0F};
  scene.ambient = {0.25F, 0.5F, 1.0F};
  scene.lights.push_back({.name = "sun", .direction = {0, -1, 0}, .intensity = glm::vec3(2.0F)});
  const Camera camera = camera_at({0, 3, 0}, {0, 0, 0}, 1, {0, 0, -1});
  const SurfaceLayer layer = trace_surfaces(scene, camera);
  const float* pixel = layer.radiance.at(0, 0);
  EXPECT_NEAR(pixel[0], 0.25 * (0.25 + 2.0 / pi), 1e-6);
  EXPECT_NEAR(pixel[1], 0.125 * (0.5 + 2.0 / pi), 1e-6);
  EXPECT_NEAR(pixel[2], 2.0 + 0.375 * (1.0 + 2.0 / pi), 1e-6);
}

TEST(ReferenceShading, SurfacesHaveTwoSides) {
  Scene scene = scene_of(make_plane({10, 10}, 1), glm::mat4(1.0F), glm::vec3(1.0F));
  scene.ambient = glm::vec3(0.125F);
  scene.lights.push_back({.name = "sun", .direction = {0, -1, 0}, .intensity = glm::vec3(1.0F)});
  const auto seen_from = [&](float y) {
    return trace_surfaces(scene, camera_at({0, y, 0}, {0, 0, 0}, 1, {0, 0, -1})).radiance.at(0, 0)[0];
  };
  EXPECT_NEAR(seen_from(3.0F), 0.125 + 1.0 / pi, 1e-6);
  EXPECT_NEAR(seen_from(-3.0F), 0.125, 1e-6);  // the lit side is the other one
  scene.lights[0].direction = {0, 1, 0};
  EXPECT_NEAR(seen_from(-3.0F), 0.125 + 1.0 / pi, 1e-6);
}

TEST(ReferenceShading, PointLightFallsWithTheSquareOfTheDistance) {
  Scene scene;
  scene.lights.push_back({.name = "lamp", .kind = LightKind::point, .position = {1, 2, 3}, .intensity = {8, 4, 2}});
  const Illumination light(scene);
  const Incidence near = light.incidence(0, {1, 0, 3}), far = light.incidence(0, {1, -2, 3});
  EXPECT_NEAR(near.irradiance.x, 2.0, 1e-12);
  EXPECT_NEAR(far.irradiance.x, 0.5, 1e-12);
  EXPECT_NEAR(far.irradiance.z, 0.125, 1e-12);
  EXPECT_NEAR(glm::distance(near.to_light, glm::dvec3(0, 1, 0)), 0.0, 1e-12);
  // On a plane below it: I cos³θ / h² / π.
  const double expected = 8.0 * std::pow(std::cos(pi / 4), 3) / 4.0 / pi;
  EXPECT_NEAR(light.surface_radiance({3, 0, 3}, {0, 1, 0}, glm::dvec3(1), glm::dvec3(0)).x, expected, 1e-12);
  EXPECT_NEAR(light.medium_radiance({1, 0, 3}, glm::dvec3(0.5), glm::dvec3(0.25)).x, 0.25 + 0.5 * 2.0 / (4 * pi),
              1e-12);
  EXPECT_FALSE(light.uniform());
}

TEST(ReferenceShading, SpotFallsFromTheInnerToTheOuterCone) {
  Scene scene;
  scene.lights.push_back({.name = "lamp",
                          .kind = LightKind::spot,
                          .position = {0, 1, 0},
                          .direction = {0, -1, 0},
                          .intensity = glm::vec3(1.0F),
                          .inner_angle_deg = 20,
                          .outer_angle_deg = 40});
  const Illumination light(scene);
  // At one metre, at an angle from the axis.
  const auto at = [&](double angle_deg) {
    const double a = glm::radians(angle_deg);
    return light.incidence(0, glm::dvec3(std::sin(a), 1.0 - std::cos(a), 0)).irradiance.x;
  };
  EXPECT_NEAR(at(0), 1.0, 1e-12);
  EXPECT_NEAR(at(19.9), 1.0, 1e-12);
  EXPECT_NEAR(at(40.1), 0.0, 1e-12);
  EXPECT_NEAR(at(120), 0.0, 1e-12);
  const double middle = std::acos(0.5 * (std::cos(glm::radians(20.0)) + std::cos(glm::radians(40.0))));
  EXPECT_NEAR(at(glm::degrees(middle)), 0.5, 1e-9);
  EXPECT_GT(at(25), at(30));
  EXPECT_GT(at(30), at(35));
}

TEST(ReferenceShading, DirectionalLightIsTheSameEverywhere) {
  Scene scene;
  scene.ambient = glm::vec3(0.5F);
  scene.lights.push_back({.name = "sun", .direction = {0, -1, 0}, .intensity = {4, 4, 4}});
  const Illumination light(scene);
  EXPECT_TRUE(light.uniform());
  EXPECT_EQ(light.incidence(0, {0, 0, 0}).irradiance, light.incidence(0, {9, -3, 100}).irradiance);
  EXPECT_NEAR(light.medium_radiance({7, 7, 7}, glm::dvec3(1), glm::dvec3(0)).y, 0.5 + 1.0 / pi, 1e-12);
}

}  // namespace
}  // namespace pellucid
