#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "algorithms/reference/media/medium_path.hpp"
#include "algorithms/reference/ray_shadows.hpp"
#include "algorithms/reference/reference.hpp"
#include "algorithms/reference/shading.hpp"
#include "algorithms/scene/noise.hpp"
#include "algorithms/scene/shapes/procedural.hpp"
#include "tests/algorithms/reference/reference_scenes.hpp"

namespace pellucid {
namespace {

using namespace test;

using std::numbers::pi;

// Fog of extinction 0.4 over x in [−2, 6], y and z in [−1, 3], seen along +x through its middle.
Scene fog_scene(const glm::ivec3& size = glm::ivec3(1)) {
  Scene scene;
  scene.volume = box_volume(size, make_constant_density(size, 0.5F), box_from_to({-2, -1, -2}, {6, 3, 2}));
  scene.volume->extinction = 0.8F;
  scene.volume->albedo = {0.9F, 0.5F, 0.25F};
  return scene;
}

// ---- lights through constant fog, without their shadows and with them ----

// Single scattering of a light at `lamp` on the parts of t between neighbouring `ends`, those with `lit` true: the
// airlight integral of Sun et al. 2005 (references.bib: sun2005) without the fog's effect on the way from the light,
// which Imagire et al. 2007 leave out.
glm::dvec3 airlight(const Scene& scene, const glm::dvec3& lamp, const std::vector<double>& ends,
                    const std::vector<bool>& lit, const Illumination& light) {
  const double extinction = widened(scene.volume->extinction) * widened(scene.volume->density[0]);
  const double nearest = lamp.x + 2.0, height = glm::length(glm::dvec2(lamp.y, lamp.z));
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    if (!lit[i]) continue;
    // t = t0 + h tan u turns 1/r² into a constant.
    const auto angle = [&](double t) { return std::atan2(t - nearest, height); };
    std::vector<double> angles = {angle(ends[i]), angle(ends[i + 1])};
    for (double distance = height; distance < 10.0; distance *= 4.0) {
      for (const double t : {nearest - distance, nearest + distance}) {
        if (t > ends[i] && t < ends[i + 1]) angles.push_back(angle(t));
      }
    }
    std::sort(angles.begin(), angles.end());
    sum += quadrature(
        [&](double u) {
          const double t = nearest + height * std::tan(u), r2_over_h = height / (std::cos(u) * std::cos(u));
          return light.incidence(0, on_axis(t)).irradiance * (r2_over_h * extinction * std::exp(-extinction * t));
        },
        angles);
  }
  return glm::dvec3(scene.volume->albedo) * sum / (4.0 * pi);
}

TEST(ReferenceScattering, PointLightInConstantFogIsTheAirlightIntegral) {
  // One cell or many; a lamp in the fog, far out of it, and so near the ray that its light is a peak.
  for (const glm::ivec3& size : {glm::ivec3(1), glm::ivec3(9, 4, 6)}) {
    for (const glm::vec3& place : {glm::vec3(1, 1.5F, 0), glm::vec3(2, 0, 9), glm::vec3(3.3F, 0.01F, 0)}) {
      Scene scene = fog_scene(size);
      scene.lights = {{.name = "lamp", .kind = LightKind::point, .position = place, .intensity = {3, 2, 1}}};
      const Illumination light(scene);
      const Reference result = seen_along_x(scene);
      expect_near(result, airlight(scene, glm::dvec3(place), {0.0, 8.0}, {true}, light));
      EXPECT_EQ(result.unconverged_share, 0.0);
    }
  }
}

TEST(ReferenceScattering, APeakNarrowerThanAnyStepIsNotMissed) {
  Scene scene = fog_scene();
  scene.lights = {
      {.name = "lamp", .kind = LightKind::point, .position = {3.3F, 1e-5F, 0}, .intensity = glm::vec3(1e-4F)}};
  const Illumination light(scene);
  const glm::dvec3 expected = airlight(scene, glm::dvec3(scene.lights[0].position), {0.0, 8.0}, {true}, light);
  ReferenceOptions options;
  options.min_steps = 1;
  options.tolerance = 1e-2;
  const Reference result = one_pixel(scene, {-5, 0, 0}, {6, 0, 0}, options);
  EXPECT_GT(expected.x, 0.1) << "there is a peak";
  EXPECT_LE(std::abs(radiance(result).x - expected.x), result.step_error_max + 1e-6);
  EXPECT_LT(result.step_error_max, 1e-2);
}

// A plate over half of the spot's cone, as in reference_shadows_test.cpp: dark from t = 2.5 to 6.5.
Scene half_covered_spot() {
  Scene scene = fog_scene(glm::ivec3(7, 4, 5));
  place(scene, make_plane({2, 2}, 1), glm::translate(glm::mat4(1.0F), {1, 1, 0}));
  Light spot{.name = "spot", .kind = LightKind::spot, .position = {-0.5F, 2, 0}, .casts_shadow = true};
  spot.direction = {0, -1, 0};
  spot.inner_angle_deg = 30;
  spot.outer_angle_deg = 50;
  spot.intensity = {30, 20, 10};
  scene.lights = {spot};
  return scene;
}

TEST(ReferenceScattering, ASpotsShaftPastAPlateIsItsQuadrature) {
  Scene scene = half_covered_spot();
  const Illumination light(scene);
  const double inner = 2.0 * std::tan(glm::radians(30.0)), outer = 2.0 * std::tan(glm::radians(50.0));
  const std::vector<double> cone = {std::max(0.0, 1.5 - outer), 1.5 - inner, 1.5, 2.5, 1.5 + inner, 1.5 + outer};
  const glm::dvec3 lamp(-0.5, 2, 0);
  expect_near(seen_along_x(scene), airlight(scene, lamp, cone, {true, true, true, false, false}, light));
  scene.lights[0].casts_shadow = false;
  expect_near(seen_along_x(scene), airlight(scene, lamp, cone, {true, true, true, true, true}, light));
}

TEST(ReferenceScattering, DirectionalShadowsHaveAClosedForm) {
  Scene scene = fog_scene(glm::ivec3(6, 5, 4));
  scene.ambient = {0.1F, 0.2F, 0.4F};
  place(scene, make_plane({2, 2}, 3), glm::translate(glm::mat4(1.0F), {1, 1, 0}));
  const float h = std::numbers::sqrt2_v<float> / 2;
  scene.lights = {{.name = "sun", .direction = {-h, -h, 0}, .intensity = {4, 2, 1}, .casts_shadow = true}};
  // In shadow from x = −1 to 1, so t = 1 to 3.
  const double extinction = 0.5 * widened(0.8F);
  const double lit = 1.0 - std::exp(-extinction) + std::exp(-3 * extinction) - std::exp(-8 * extinction);
  const glm::dvec3 expected =
      glm::dvec3(scene.volume->albedo) * (glm::dvec3(scene.ambient) * (1.0 - std::exp(-8 * extinction)) +
                                          glm::dvec3(scene.lights[0].intensity) * (lit / (4 * pi)));
  const Reference result = seen_along_x(scene, 1.0);
  expect_near(result, expected);
  EXPECT_LT(result.step_error_max, 1e-7) << "no steps, only the image's rounding";
}

TEST(ReferenceScattering, ThinShadowsAreNotMissed) {
  // A comb of 100 slats, each 1 mm wide, under a sun straight above: they take their share of the light.
  Scene scene = fog_scene();
  place(scene, make_box({0.001F, 0.01F, 1}), glm::mat4(1.0F));
  scene.instances.clear();
  for (int i = 0; i < 100; ++i) {
    const float x = -1.9F + 0.04F * static_cast<float>(i);
    scene.instances.push_back({"slat", 0, 0, glm::translate(glm::mat4(1.0F), {x, 1, 0}), glm::vec3(1)});
  }
  scene.lights = {{.name = "sun", .direction = {0, -1, 0}, .intensity = {4, 2, 1}, .casts_shadow = true}};
  ReferenceOptions options;
  options.min_steps = 1;
  const glm::dvec3 with = radiance(one_pixel(scene, {-5, 0, 0}, {6, 0, 0}, options));
  const double extinction = 0.5 * widened(0.8F);
  double taken = 0;
  for (int i = 0; i < 100; ++i) {
    const double t = 0.1 + 0.04 * i;
    taken += std::exp(-extinction * (t - 0.0005)) - std::exp(-extinction * (t + 0.0005));
  }
  const glm::dvec3 full = glm::dvec3(scene.volume->albedo) * glm::dvec3(scene.lights[0].intensity) / (4 * pi);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(with[c], full[c] * (1 - std::exp(-8 * extinction) - taken), 1e-5 * full[c]);
}

TEST(ReferenceScattering, ALightInAClosedBoxDoesNotLeaveIt) {
  Scene scene = fog_scene();
  place(scene, make_box({1, 1, 1}), glm::translate(glm::mat4(1.0F), {2, 1.5F, 0}));
  scene.lights = {{.name = "lamp", .kind = LightKind::point, .position = {2, 1.5F, 0}, .casts_shadow = true}};
  EXPECT_EQ(radiance(seen_along_x(scene)), glm::dvec3(0.0));
  scene.lights[0].casts_shadow = false;
  EXPECT_GT(radiance(seen_along_x(scene)).x, 1e-3);
}

TEST(ReferenceScattering, ALightOnTheRayIsFinite) {
  Scene scene = fog_scene();
  Light spot{.name = "spot", .kind = LightKind::spot, .position = {-5, 0, 0}, .casts_shadow = true};
  spot.direction = {1, 0, 0};
  scene.lights = {spot};
  // Carried by the viewer: 1/t² along the axis, from 3 m on.
  const double extinction = 0.5 * widened(0.8F);
  const double sum = quadrature(
      [&](double t) { return extinction * std::exp(-extinction * t) / ((t + 3.0) * (t + 3.0)); }, {0.0, 8.0});
  expect_near(seen_along_x(scene), glm::dvec3(scene.volume->albedo) * sum / (4.0 * pi));
  scene.lights[0].position = {1, 0, 0};  // in the fog, on the ray: without bound
  const Reference boundless = one_pixel(scene, {-5, 0, 0}, {6, 0, 0});
  EXPECT_TRUE(std::isfinite(radiance(boundless).x));
  EXPECT_GT(radiance(boundless).x, 0.0);
  EXPECT_EQ(boundless.unconverged_share, 1.0);
}

// ---- a volume in a light's space ----

TEST(ReferenceScattering, AVolumeInALightsSpaceScattersWhatItsVoxelsStore) {
  Scene scene = half_covered_spot();
  Light other{.name = "other", .kind = LightKind::point, .position = {1, 2, 1}, .intensity = glm::vec3(50)};
  scene.lights.insert(scene.lights.begin(), other);
  scene.ambient = {0.1F, 0.1F, 0.3F};
  scene.volume->light = 1;
  scene.volume->scattering.resize(scene.volume->density.size());
  Random random(3);
  for (float& v : scene.volume->scattering)
    v = random.range(0.0F, 0.2F);
  Volume stored = *scene.volume;
  stored.density = stored.scattering;

  const double extinction = 0.5 * widened(0.8F);
  std::vector<double> ends = {0.0};  // planes of voxel centres
  for (int i = 0; i < 7; ++i)
    ends.push_back((i + 0.5) * 8.0 / 7.0);
  ends.push_back(8.0);
  const auto scattered = [&](double from, double to) {
    std::vector<double> parts;
    for (const double end : ends)
      parts.push_back(std::clamp(end, from, to));
    parts.erase(std::unique(parts.begin(), parts.end()), parts.end());
    return quadrature([&](double t) { return extinction * std::exp(-extinction * t) * density_at(stored, on_axis(t)); },
                      parts, 200);
  };
  const glm::dvec3 albedo(scene.volume->albedo);
  const glm::dvec3 ambient = glm::dvec3(scene.ambient) * (1.0 - std::exp(-8.0 * extinction));
  const glm::dvec3 intensity = glm::dvec3(scene.lights[1].intensity) / (4.0 * pi);
  // The plate's shadow lies from t = 2.5 to 6.5; the cone's edge is in the voxels, not in the light.
  expect_near(seen_along_x(scene), albedo * (ambient + intensity * (scattered(0.0, 2.5) + scattered(6.5, 8.0))));
  scene.lights[1].casts_shadow = false;
  expect_near(seen_along_x(scene), albedo * (ambient + intensity * scattered(0.0, 8.0)));
}

// ---- the stated error ----

TEST(ReferenceScattering, TheStatedErrorBoundsTheTrueOneWithEverythingAtOnce) {
  Scene scene;
  scene.volume = kinked_volume();
  scene.ambient = {0.2F, 0.1F, 0.1F};
  Random random(12);
  const auto within = [&] {  // one after the other: a call's arguments are drawn in an order that the compiler chooses
    const float z = random.range(-2, 2), y = random.range(-1, 3), x = random.range(-2, 6);
    return glm::vec3(x, y, z);
  };
  place(scene, make_box({0.3F, 0.4F, 0.2F}), glm::mat4(1.0F));
  scene.instances.clear();
  for (int i = 0; i < 20; ++i)
    scene.instances.push_back({"box", 0, 0, glm::translate(glm::mat4(1.0F), within()), glm::vec3(1)});
  Light lamp{.name = "lamp", .kind = LightKind::point, .position = {1, 2, 0.4F}, .casts_shadow = true};
  lamp.intensity = glm::vec3(4);
  Light spot{.name = "spot", .kind = LightKind::spot, .position = {4, 3.5F, 0}, .casts_shadow = true};
  spot.direction = glm::normalize(glm::vec3(-1, -2, 0.1F));
  spot.intensity = glm::vec3(20);
  scene.lights = {lamp, spot, {.name = "sun", .direction = {0.6F, -0.8F, 0}, .casts_shadow = true}};

  const Camera camera = camera_at({-4, 1.5F, 5}, {2, 0.8F, 0}, 12, 9);
  const SurfaceLayer black = flat_surfaces(camera, glm::vec3(0), kInfinity);
  ReferenceOptions options;
  options.tolerance = 1e-11;
  const Reference exact = render_reference(scene, camera, black, options);
  EXPECT_EQ(exact.unconverged_share, 0.0);
  double before = kInfinity;
  for (const double tolerance : {0.3, 1e-2, 1e-3, 1e-4, 1e-6}) {
    options.tolerance = tolerance;
    options.min_steps = 1;
    const Reference result = render_reference(scene, camera, black, options);
    double error = 0;
    for (std::size_t i = 0; i < result.image.pixels.size(); ++i)
      error = std::max(error, std::abs(widened(result.image.pixels[i]) - widened(exact.image.pixels[i])));
    EXPECT_LE(error, result.step_error_max + 1e-7);
    EXPECT_LT(result.step_error_max, tolerance + 1e-6);
    EXPECT_LE(error, before + 1e-7);
    before = error;
  }

  // And what it converges to, marched along one ray.
  const Camera middle = camera_at(camera.view.eye, camera.view.target, 1, 1);
  const glm::dvec3 o(camera.view.eye), d = middle.ray_direction(0.5, 0.5);
  const MediumGrid grid(*scene.volume);
  const Interval inside = grid.clip(o, d, {0.01, kInfinity});
  const Illumination light(scene);
  const RayShadows shadows(scene);
  std::vector<Interval> dark[3];
  for (std::size_t l = 0; l < 3; ++l) {
    const bool sun = l == 2;
    shadows.find(o, d, inside,
                 sun ? glm::dvec4(-glm::dvec3(scene.lights[l].direction), 0)
                     : glm::dvec4(glm::dvec3(scene.lights[l].position), 1),
                 dark[l]);
  }
  glm::dvec3 marched(0.0);
  double depth = 0;
  const int steps = 200000;
  const double dt = (inside.end - inside.begin) / steps;
  for (int i = 0; i < steps; ++i) {
    const double t = inside.begin + (i + 0.5) * dt;
    const Mapped at = mapped(*scene.volume, density_at(*scene.volume, o + t * d));
    glm::dvec3 incident(scene.ambient);
    for (std::size_t l = 0; l < 3; ++l) {
      const bool hidden = std::any_of(dark[l].begin(), dark[l].end(),
                                      [&](const Interval& part) { return t > part.begin && t < part.end; });
      if (!hidden) incident += light.incidence(l, o + t * d).irradiance / (4.0 * pi);
    }
    marched += at.albedo * incident * (at.extinction * std::exp(-depth - 0.5 * at.extinction * dt) * dt);
    depth += at.extinction * dt;
  }
  const glm::dvec3 one = radiance(one_pixel(scene, camera.view.eye, camera.view.target));
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(one[c], marched[c], 2e-5);
  EXPECT_GT(dark[0].size() + dark[1].size() + dark[2].size(), 2U);
}

}  // namespace
}  // namespace pellucid
