#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "algorithms/reference/box_tree.hpp"
#include "algorithms/reference/geometry.hpp"
#include "algorithms/reference/ray_shadows.hpp"
#include "algorithms/reference/reference.hpp"
#include "algorithms/reference/shading.hpp"
#include "algorithms/scene/noise.hpp"
#include "algorithms/scene/shapes/procedural.hpp"
#include "tests/algorithms/reference/reference_scenes.hpp"

namespace pellucid {
namespace {

using namespace test;

// A plate in y = 1 over x in [0, 2], z in [−1, 1].
Scene plate_scene(int segments = 1) {
  Scene scene;
  place(scene, make_plane({2, 2}, segments), glm::translate(glm::mat4(1.0F), {1, 1, 0}));
  return scene;
}

std::vector<Interval> shadows_on(const Scene& scene, const glm::dvec3& origin, const glm::dvec3& direction,
                                 const Interval& part, const glm::dvec4& light) {
  std::vector<Interval> found;
  RayShadows(scene).find(origin, direction, part, light, found);
  return found;
}

// ---- where shadows lie on a ray ----

TEST(BoxTree, VisitsEveryItemOnceAndOnlyWhatTouches) {
  Random random(9);
  std::vector<Box> boxes(1000);
  for (Box& box : boxes) {
    const glm::vec3 p(random.next(), random.next(), random.next());
    box.add(p);
    box.add(p + 0.02F);
  }
  const BoxTree tree(boxes);
  const auto left = [](const Box& box) { return box.low.x < 0.25F; };
  std::vector<int> seen(boxes.size(), 0);
  tree.traverse(left, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      ++seen[tree.order()[i]];
  });
  int visited = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    EXPECT_LE(seen[i], 1);
    EXPECT_TRUE(seen[i] == 1 || !left(boxes[i]));
    visited += seen[i];
  }
  EXPECT_LT(visited, 400) << "most of the others are passed over";
}

TEST(RayShadows, APlatesEdgesAreExact) {
  for (const int segments : {1, 7}) {
    const Scene scene = plate_scene(segments);
    // Through (0, 1) and (2, 1) from (−1/2, 2) to y = 0.
    const auto lamp = shadows_on(scene, {-3, 0, 0}, {1, 0, 0}, {0.0, 20.0}, {-0.5, 2, 0, 1});
    ASSERT_EQ(lamp.size(), 1U);
    EXPECT_NEAR(lamp[0].begin, 3.5, 1e-12);
    EXPECT_NEAR(lamp[0].end, 7.5, 1e-12);
    // Cut to the part that was asked for.
    const auto part = shadows_on(scene, {-3, 0, 0}, {1, 0, 0}, {4.0, 5.0}, {-0.5, 2, 0, 1});
    ASSERT_EQ(part.size(), 1U);
    EXPECT_EQ(part[0].begin, 4.0);
    EXPECT_EQ(part[0].end, 5.0);
    // A sun at 45°.
    const double h = std::numbers::sqrt2 / 2;
    const auto sun = shadows_on(scene, {-3, 0, 0.3}, {1, 0, 0}, {0.0, 20.0}, {h, h, 0, 0});
    ASSERT_EQ(sun.size(), 1U);
    EXPECT_NEAR(sun[0].begin, 2.0, 1e-12);
    EXPECT_NEAR(sun[0].end, 4.0, 1e-12);
  }
}

TEST(RayShadows, OnlyWhatLiesBetweenCastsThem) {
  const Scene scene = plate_scene();
  const auto on_x_axis = [&](const glm::dvec4& light) {
    return shadows_on(scene, {-3, 0, 0}, {1, 0, 0}, {0.0, 20.0}, light).size();
  };
  EXPECT_EQ(on_x_axis({1, 2, 0, 1}), 1U);
  EXPECT_EQ(on_x_axis({1, 0.5, 0, 1}), 0U) << "the plate lies beyond the lamp";
  EXPECT_EQ(on_x_axis({1, -2, 0, 1}), 0U) << "the plate lies on the other side of the ray";
  EXPECT_EQ(on_x_axis({0, -1, 0, 0}), 0U);
  EXPECT_EQ(shadows_on(scene, {-3, 0, 5}, {1, 0, 0}, {0.0, 20.0}, {1, 2, 5, 1}).size(), 0U) << "it passes beside";
}

TEST(RayShadows, AnObjectAtTheLightsHeightShadesTheRayForEver) {
  // A wall in x = 1 from below the ray up past the lamp.
  Scene scene;
  place(scene, make_box({0.1F, 10, 10}), glm::translate(glm::mat4(1.0F), {1.05F, 0, 0}));
  const auto shadow = shadows_on(scene, {-3, 0, 0}, {1, 0, 0}, {0.0, 1000.0}, {0, 2, 0, 1});
  ASSERT_EQ(shadow.size(), 1U);
  EXPECT_NEAR(shadow[0].begin, 4.0, 1e-6);
  EXPECT_EQ(shadow[0].end, 1000.0);
}

TEST(RayShadows, ALightOnTheRay) {
  // A plate across the ray at x = 1: a lamp at x = 3 lights what lies behind the plate.
  Scene scene;
  place(scene, make_box({0.02F, 1, 1}), glm::translate(glm::mat4(1.0F), {1, 0, 0}));
  const glm::dvec3 o(-1, 0.1, 0.05), d(1, 0, 0);
  const auto ahead = shadows_on(scene, o, d, {0.0, 10.0}, {3, 0.1, 0.05, 1});
  ASSERT_EQ(ahead.size(), 1U);
  EXPECT_NEAR(ahead[0].begin, 0.0, 1e-6);
  EXPECT_NEAR(ahead[0].end, 2.01, 1e-6);
  const auto sun = shadows_on(scene, o, d, {0.0, 10.0}, {1, 0, 0, 0});
  ASSERT_EQ(sun.size(), 1U);
  EXPECT_NEAR(sun[0].end, 2.01, 1e-6);
  // A lamp at the eye lights all up to the plate.
  const auto at_eye = shadows_on(scene, o, d, {0.0, 1.98}, glm::dvec4(o, 1));
  EXPECT_TRUE(at_eye.empty());
}

TEST(RayShadows, AgreeWithShadowRaysInACrowd) {
  Random random(11);
  const auto point = [&](float size) {
    return glm::vec3(random.range(-size, size), random.range(-size, size), random.range(-size, size));
  };
  Scene scene;
  Mesh soup;
  for (unsigned i = 0; i < 60; ++i) {
    const glm::vec3 centre = point(1.0F);
    for (int c = 0; c < 3; ++c)
      soup.positions.push_back(centre + point(0.15F));
    soup.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  soup.normals.assign(soup.positions.size(), glm::vec3(0, 1, 0));
  place(scene, soup, glm::mat4(1.0F));
  place(scene, make_torus(0.8F, 0.1F, 12),
        glm::scale(glm::rotate(glm::mat4(1.0F), 0.8F, {1, 0.5F, 0}), {1.5F, 0.6F, 1}));
  scene.instances.push_back(scene.instances[1]);
  scene.instances.back().to_world = glm::translate(scene.instances[0].to_world, {0.2F, 1.0F, 0.4F});
  const Geometry geometry(scene);
  const RayShadows shadows(scene);

  int dark = 0, compared = 0;
  for (int i = 0; i < 1500; ++i) {
    const glm::dvec3 o(point(3.0F)), d = glm::normalize(glm::dvec3(point(1.0F)) - o);
    const bool sun = i % 2 == 0;
    const glm::dvec3 place = sun ? glm::normalize(glm::dvec3(point(1.0F))) : glm::dvec3(point(2.0F));
    std::vector<Interval> found;
    shadows.find(o, d, {0.5, 6.0}, {place, sun ? 0.0 : 1.0}, found);
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_LT(found[k].begin, found[k].end);
      EXPECT_TRUE(k == 0 || found[k - 1].end < found[k].begin);
    }
    for (int k = 0; k < 40; ++k) {
      const double t = static_cast<double>(random.range(0.5F, 6.0F));
      bool inside = false;
      double edge = kInfinity;
      for (const Interval& shadow : found) {
        inside = inside || (t > shadow.begin && t < shadow.end);
        edge = std::min({edge, std::abs(t - shadow.begin), std::abs(t - shadow.end)});
      }
      if (edge < 1e-4) continue;  // Embree's single precision
      const glm::dvec3 p = o + t * d, to_light = sun ? place : place - p;
      EXPECT_EQ(geometry.occluded(p, glm::normalize(to_light), 0.0, sun ? 1e6 : glm::length(to_light)), inside);
      dark += inside ? 1 : 0;
      ++compared;
    }
  }
  EXPECT_GT(compared, 55000);
  EXPECT_GT(dark, 5000);
}

// ---- shadows on surfaces ----

// A floor and a box above it, a sun and two lamps; all faces flat.
Scene room() {
  Scene scene;
  place(scene, make_plane({8, 8}, 1), glm::mat4(1.0F));
  place(scene, make_box({1, 1, 1}),
        glm::rotate(glm::translate(glm::mat4(1.0F), {0.2F, 1.2F, 0}), 0.5F, glm::vec3(1, 2, 0.5F)));
  scene.ambient = glm::vec3(0.1F);
  scene.environment.zenith = {0, 0, 1};
  scene.environment.horizon = {0.5F, 0.5F, 0.5F};
  Light sun{.name = "sun", .direction = glm::normalize(glm::vec3(1, -2, -0.5F)), .casts_shadow = true};
  Light lamp{.name = "lamp", .kind = LightKind::point, .position = {1, 3, 1}, .casts_shadow = true};
  lamp.intensity = glm::vec3(5);
  Light spot{.name = "spot", .kind = LightKind::spot, .position = {-2, 3, 1}, .casts_shadow = true};
  spot.direction = glm::normalize(glm::vec3(2, -3, -1));
  spot.intensity = glm::vec3(20);
  scene.lights = {sun, lamp, spot};
  return scene;
}

// A rasteriser would give these: distances in single precision.
SurfacePoints raster_points(const Scene& scene, const Camera& camera) {
  SurfacePoints points;
  points.albedo = points.normal = points.emission = Image(camera.width, camera.height, 3);
  const Geometry geometry(scene);
  const glm::dvec3 eye(camera.view.eye);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const glm::dvec3 d = camera.ray_direction(x + 0.5, y + 0.5);
      const Hit hit = geometry.intersect(eye, d, 0.1, 100.0);
      points.distance_m.push_back(static_cast<double>(static_cast<float>(hit.distance)));
      if (hit.instance == nullptr) continue;
      const Mesh& mesh = scene.meshes[static_cast<std::size_t>(hit.instance->mesh)];
      glm::vec3 n = glm::normalize(glm::mat3(hit.instance->to_world) * mesh.normals[hit.triangle.x]);
      if (glm::dot(glm::dvec3(n), d) > 0.0) n = -n;
      const glm::vec3& albedo = scene.materials[0].albedo;
      for (int c = 0; c < 3; ++c) {
        points.normal.at(x, y)[c] = n[c];
        points.albedo.at(x, y)[c] = albedo[c];
      }
    }
  }
  return points;
}

TEST(ReferenceShadows, ShadingGivenPointsIsTracing) {
  Scene scene = room();
  const Camera camera = camera_at({2, 3, 5}, {0, 0.5F, 0}, 96, 72, 0.1F);
  const SurfaceLayer traced = trace_surfaces(scene, camera);
  const SurfaceLayer shaded = shade_surfaces(scene, camera, raster_points(scene, camera));
  for (Light& light : scene.lights)
    light.casts_shadow = false;
  const SurfaceLayer unshadowed = trace_surfaces(scene, camera);
  int apart = 0, dark = 0, sky = 0;
  for (std::size_t i = 0; i < traced.distance_m.size(); ++i) {
    const float* a = &traced.radiance.pixels[3 * i];
    const float* b = &shaded.radiance.pixels[3 * i];
    if (std::isinf(traced.distance_m[i])) {
      EXPECT_TRUE(std::isinf(shaded.distance_m[i]));
      ++sky;
    }
    for (int c = 0; c < 3; ++c)
      apart += std::abs(a[c] - b[c]) > 1e-5F ? 1 : 0;
    EXPECT_LE(a[0], unshadowed.radiance.pixels[3 * i] + 1e-6F);
    dark += a[0] < unshadowed.radiance.pixels[3 * i] - 1e-3F ? 1 : 0;
  }
  EXPECT_LE(apart, 6) << "a shadow's edge may fall on a pixel's centre";
  EXPECT_GT(dark, 300);
  EXPECT_GT(sky, 100);
}

TEST(ReferenceShadows, ThePlatesShadowOnAFloorEndsWhereGeometrySays) {
  Scene scene = plate_scene();
  place(scene, make_plane({40, 40}, 1), glm::mat4(1.0F));
  Light lamp{.name = "lamp", .kind = LightKind::point, .position = {-0.5F, 2, 0}, .casts_shadow = true};
  scene.lights = {lamp};
  // From between floor and plate.
  const auto lit = [&](float x) {
    return trace_surfaces(scene, camera_at({x, 0.5F, 0.001F}, {x, 0, 0}, 1, 1)).radiance.at(0, 0)[0] > 0.0F;
  };
  EXPECT_TRUE(lit(0.499F));
  EXPECT_FALSE(lit(0.501F));
  EXPECT_FALSE(lit(4.499F));
  EXPECT_TRUE(lit(4.501F));
  scene.lights[0].position = {1.5F, 0.9F, 0};
  EXPECT_TRUE(lit(2.0F)) << "the plate lies beyond the lamp";
  scene.lights[0].position = {-0.5F, 2, 0};
  EXPECT_FALSE(lit(2.0F));
  scene.lights[0].casts_shadow = false;
  EXPECT_TRUE(lit(2.0F));
}

TEST(ReferenceShadows, SurfacesDoNotShadeThemselves) {
  // A single plane under a grazing sun, near and far from the origin and the eye.
  for (const float scale : {0.01F, 1.0F, 1000.0F}) {
    Scene scene;
    const glm::vec3 centre = scale * glm::vec3(3, -2, 5);
    const glm::mat4 to_world =
        glm::scale(glm::rotate(glm::translate(glm::mat4(1.0F), centre), 0.7F, glm::normalize(glm::vec3(1, 0.3F, 0.2F))),
                   glm::vec3(scale));
    place(scene, make_plane({4, 4}, 16), to_world);
    const glm::vec3 normal = glm::normalize(glm::vec3(to_world[1])), along = glm::normalize(glm::vec3(to_world[0]));
    scene.lights = {{.name = "sun", .direction = -glm::normalize(along + 0.05F * normal), .casts_shadow = true}};
    Camera camera = camera_at(centre + scale * (3.0F * normal + along), centre, 48, 48, 0.01F * scale);
    camera.view.far_m = 100.0F * scale;
    const SurfaceLayer layer = trace_surfaces(scene, camera);
    int hits = 0;
    for (std::size_t i = 0; i < layer.distance_m.size(); ++i) {
      if (std::isinf(layer.distance_m[i])) continue;
      EXPECT_GT(layer.radiance.pixels[3 * i], 0.0F);
      ++hits;
    }
    EXPECT_GT(hits, 1000);
  }
}

}  // namespace
}  // namespace pellucid
