#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "algorithms/reference/media/medium_path.hpp"
#include "algorithms/reference/reference.hpp"
#include "algorithms/reference/shading.hpp"
#include "algorithms/scene/noise.hpp"
#include "algorithms/scene/shapes/procedural.hpp"
#include "tests/algorithms/reference/reference_scenes.hpp"

namespace pellucid {
namespace {

using namespace test;

// Length of o + t·d, t in [begin, end], inside the box from low to high, by a way of its own.
double length_inside(const glm::dvec3& o, const glm::dvec3& d, double begin, double end, const glm::dvec3& low,
                     const glm::dvec3& high) {
  for (int axis = 0; axis < 3; ++axis) {
    double t0 = (low[axis] - o[axis]) / d[axis], t1 = (high[axis] - o[axis]) / d[axis];
    if (t0 > t1) std::swap(t0, t1);
    begin = std::max(begin, t0);
    end = std::min(end, t1);
  }
  return std::max(0.0, end - begin);
}

double depth_between(const Volume& volume, const glm::dvec3& a, const glm::dvec3& b) {
  const MediumGrid grid(volume);
  const glm::dvec3 d = glm::normalize(b - a);
  return grid.optical_depth(a, d, grid.clip(a, d, {0.0, glm::distance(a, b)}));
}

// ---- optical depth ----

TEST(ReferenceMedium, HomogeneousBoxIsBeerLambert) {
  const glm::dvec3 low(-1, -0.5, -2), high(2, 0.75, 1);
  Volume volume = box_volume({5, 3, 7}, make_constant_density({5, 3, 7}, 0.6F), box_from_to(low, high));
  volume.extinction = 1.5F;
  const double sigma = static_cast<double>(1.5F) * static_cast<double>(0.6F);
  const MediumGrid grid(volume);
  Random random(1);
  int inside = 0;
  for (int i = 0; i < 5000; ++i) {
    const glm::dvec3 o{random.range(-4, 4), random.range(-3, 3), random.range(-4, 4)};
    const glm::dvec3 d = glm::normalize(glm::dvec3{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)});
    const double near = static_cast<double>(random.range(0, 2)), far = near + static_cast<double>(random.range(0, 6));
    const double expected = length_inside(o, d, near, far, low, high);
    inside += expected > 0 ? 1 : 0;
    EXPECT_NEAR(grid.optical_depth(o, d, grid.clip(o, d, {near, far})), sigma * expected, 1e-12);
  }
  EXPECT_GT(inside, 300);
}

TEST(ReferenceMedium, RaysAlongAxesEdgesAndVoxelPlanesLoseNothing) {
  const Volume volume = box_volume(glm::ivec3(4), make_constant_density(glm::ivec3(4), 1.0F), glm::mat4(1.0F));
  // Through voxel centres' planes, cell corners, and along the diagonal.
  EXPECT_NEAR(depth_between(volume, {-1, 0.125, 0.125}, {2, 0.125, 0.125}), 1.0, 1e-13);
  EXPECT_NEAR(depth_between(volume, {-1, 0.375, 0.625}, {2, 0.375, 0.625}), 1.0, 1e-13);
  EXPECT_NEAR(depth_between(volume, {0.5, 2, 0.5}, {0.5, -2, 0.5}), 1.0, 1e-13);
  EXPECT_NEAR(depth_between(volume, {-1, -1, -1}, {2, 2, 2}), std::sqrt(3.0), 1e-13);
  EXPECT_NEAR(depth_between(volume, {2, 2, 2}, {-1, -1, -1}), std::sqrt(3.0), 1e-13);
  EXPECT_EQ(depth_between(volume, {-1, 1.5, 0.5}, {2, 1.5, 0.5}), 0.0);
}

TEST(ReferenceMedium, LinearRampIsTheMeanOfItsEnds) {
  const glm::ivec3 size(8, 6, 5);
  std::vector<float> density(8U * 6U * 5U);
  const auto value = [&](const glm::dvec3& local) { return 0.3 + 0.5 * local.x + 0.75 * local.y - 0.25 * local.z; };
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        density[static_cast<std::size_t>((z * size.y + y) * size.x + x)] =
            static_cast<float>(value((glm::dvec3(x, y, z) + 0.5) / glm::dvec3(size)));
      }
    }
  }
  const Volume volume = box_volume(size, density, box_from_to(glm::vec3(0), glm::vec3(2)));
  // Between the outermost voxel centres nothing is clamped, so the density is linear.
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 a{random.range(0.2F, 1.8F), random.range(0.2F, 1.8F), random.range(0.3F, 1.7F)};
    const glm::dvec3 b{random.range(0.2F, 1.8F), random.range(0.2F, 1.8F), random.range(0.3F, 1.7F)};
    const double mean = 0.5 * (value(a / 2.0) + value(b / 2.0));
    EXPECT_NEAR(depth_between(volume, a, b), mean * glm::distance(a, b), 1e-6);  // voxels are floats
  }
  // Along x over the whole box the clamped ends add half a voxel of the outermost values: again the mean.
  EXPECT_NEAR(depth_between(volume, {-1, 1, 1}, {3, 1, 1}), 2.0 * value({0.5, 0.5, 0.5}), 1e-6);
}

TEST(ReferenceMedium, AgreesWithMarchingThroughRandomVoxelsOfATurnedBox) {
  const glm::ivec3 size(5, 4, 6);
  std::vector<float> density(120);
  Random random(3);
  for (float& v : density)
    v = random.next();
  glm::mat4 to_world = glm::rotate(glm::translate(glm::mat4(1.0F), {0.3F, -0.2F, 0.5F}), 0.7F, {1, 2, 0.5F});
  to_world = glm::scale(to_world, {2.0F, 1.0F, 1.5F});
  const Volume volume = box_volume(size, density, to_world);
  const MediumGrid grid(volume);
  for (int i = 0; i < 12; ++i) {
    const auto local = [&] { return glm::vec4{random.next(), random.next(), random.next(), 1.0F}; };
    const glm::dvec3 a(glm::dmat4(to_world) * glm::dvec4(local())), b(glm::dmat4(to_world) * glm::dvec4(local()));
    const int steps = 20000;
    double marched = 0;
    for (int k = 0; k < steps; ++k)
      marched += density_at(volume, glm::mix(a, b, (k + 0.5) / steps));
    marched *= glm::distance(a, b) / steps;
    EXPECT_NEAR(depth_between(volume, a, b), marched, 1e-7);
  }
}

// ---- pictures ----

TEST(ReferencePicture, HomogeneousBoxFromOutsideInsideAndWithASurfaceInTheMiddle) {
  Scene scene;
  scene.ambient = {0.5F, 0.25F, 1.0F};
  const glm::dvec3 low(-1), high(1);
  scene.volume = box_volume(glm::ivec3(4), make_constant_density(glm::ivec3(4), 1.0F), box_from_to(low, high));
  scene.volume->extinction = 0.8F;
  scene.volume->albedo = {1.0F, 0.5F, 0.25F};
  scene.volume->emission = {0.0F, 0.125F, 0.0F};
  const glm::dvec3 source(0.5, 0.25, 0.25);
  const glm::vec3 behind(2.0F, 0.5F, 0.0F);
  const double extinction = static_cast<double>(0.8F);

  struct Case {
    glm::vec3 eye;
    float near_m;
    double surface_m;
  };
  for (const Case& c : {Case{{0.3F, 0.4F, 4.0F}, 0.1F, kInfinity}, Case{{0.3F, 0.4F, 4.0F}, 0.1F, 4.1},
                        Case{{0.2F, -0.1F, 0.5F}, 0.1F, kInfinity}, Case{{0.2F, -0.1F, 0.5F}, 0.4F, 0.9},
                        Case{{0.0F, 0.1F, 1.05F}, 0.1F, kInfinity}}) {
    const Camera camera = camera_at(c.eye, {0.05F, 0.02F, -1.0F}, 16, 12, c.near_m);
    const Reference result = render_reference(scene, camera, flat_surfaces(camera, behind, c.surface_m));
    const glm::dvec3 eye(c.eye), forward = glm::normalize(glm::dvec3(camera.view.target) - eye);
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const glm::dvec3 d = camera.ray_direction(x + 0.5, y + 0.5);
        const double near = static_cast<double>(c.near_m) / glm::dot(d, forward);
        const double length = length_inside(eye, d, near, c.surface_m, low, high);
        const double transmittance = std::exp(-extinction * length);
        const float* pixel = result.image.at(x, y);
        for (int k = 0; k < 3; ++k) {
          const double expected = source[k] * (1.0 - transmittance) + transmittance * static_cast<double>(behind[k]);
          EXPECT_NEAR(static_cast<double>(pixel[k]), expected, 2.0 * kFloatRounding);
        }
        EXPECT_NEAR(static_cast<double>(pixel[3]), transmittance, kFloatRounding);
        EXPECT_EQ(*result.mask.at(x, y), length > 0.0 ? 1.0F : 0.0F);
      }
    }
    EXPECT_LE(result.step_error_max, kFloatRounding * 2.0);
    EXPECT_EQ(result.unconverged_share, 0.0);
  }
}

TEST(ReferencePicture, WithoutAVolumeItIsTheSurfaces) {
  const Scene scene;
  const Camera camera = camera_at({0, 0, 3}, {0, 0, 0}, 4, 3);
  const Reference result = render_reference(scene, camera, flat_surfaces(camera, {0.1F, 0.2F, 0.3F}, 2.0));
  for (int x = 0; x < 4; ++x) {
    EXPECT_EQ(result.image.at(x, 1)[1], 0.2F);
    EXPECT_EQ(result.image.at(x, 1)[3], 1.0F);
    EXPECT_EQ(*result.mask.at(x, 1), 0.0F);
  }
  EXPECT_EQ(result.step_error_max, 0.0);
}

TEST(ReferencePicture, ReportsProgressToTheEnd) {
  const Scene scene;
  const Camera camera = camera_at({0, 0, 3}, {0, 0, 0}, 4, 7);
  std::atomic<int> calls{0}, complete{0};
  ReferenceOptions options;
  options.progress = [&](double share) {
    ++calls;
    if (share == 1.0) ++complete;
  };
  render_reference(scene, camera, flat_surfaces(camera, glm::vec3(0), kInfinity), options);
  EXPECT_EQ(calls, 7);
  EXPECT_EQ(complete, 1);
}

// ---- light that depends on the place ----

// A coarse, uneven volume with a lamp beside it and a spot above.
Scene lit_scene() {
  Scene scene;
  std::vector<float> density(27);
  Random random(4);
  for (float& v : density)
    v = random.range(0.2F, 1.0F);
  scene.volume = box_volume(glm::ivec3(3), density, box_from_to(glm::vec3(-1), glm::vec3(1)));
  scene.volume->extinction = 1.2F;
  Light lamp;
  lamp.kind = LightKind::point;
  lamp.position = {0.4F, 0.3F, 0.2F};
  lamp.intensity = {3, 2, 1};
  Light spot;
  spot.kind = LightKind::spot;
  spot.position = {-1.5F, 2.0F, 0.5F};
  spot.direction = glm::normalize(glm::vec3(1.0F, -1.4F, -0.4F));
  spot.intensity = {10, 10, 20};
  scene.lights = {lamp, spot};
  return scene;
}

// Midpoint marching in the plainest way, Richardson-extrapolated.
glm::dvec3 march(const Scene& scene, const glm::dvec3& o, const glm::dvec3& d, double begin, double end) {
  const Illumination light(scene);
  const auto at = [&](int steps) {
    const double dt = (end - begin) / steps;
    glm::dvec3 sum(0.0);
    double depth = 0;
    for (int i = 0; i < steps; ++i) {
      const glm::dvec3 p = o + (begin + (i + 0.5) * dt) * d;
      const double sigma = static_cast<double>(scene.volume->extinction) * density_at(*scene.volume, p);
      const glm::dvec3 source =
          light.medium_radiance(p, glm::dvec3(scene.volume->albedo), glm::dvec3(scene.volume->emission));
      sum += source * (sigma * std::exp(-depth - 0.5 * sigma * dt) * dt);
      depth += sigma * dt;
    }
    return sum;
  };
  return (4.0 * at(20000) - at(10000)) / 3.0;
}

TEST(ReferencePicture, StatedStepErrorBoundsTheTrueOneAndFallsWithTheTolerance) {
  const Scene scene = lit_scene();
  for (const glm::vec3& eye : {glm::vec3(0.2F, 0.5F, 4), glm::vec3(3, 2, 2.5F), glm::vec3(-0.5F, 0.1F, 0.8F)}) {
    const Camera camera = camera_at(eye, {0.25F, 0.1F, 0}, 1, 1);
    const glm::dvec3 o(eye), d = camera.ray_direction(0.5, 0.5);
    const MediumGrid grid(*scene.volume);
    const Interval inside = grid.clip(o, d, {static_cast<double>(camera.view.near_m), kInfinity});
    const glm::dvec3 expected = march(scene, o, d, inside.begin, inside.end);
    const SurfaceLayer black = flat_surfaces(camera, glm::vec3(0), kInfinity);

    double before = kInfinity;
    for (double tolerance = 0.5; tolerance > 1e-5; tolerance /= 2.0) {
      ReferenceOptions options;
      options.min_steps = 1;
      options.tolerance = tolerance;
      const Reference result = render_reference(scene, camera, black, options);
      const double error = worst(result.image, expected);
      EXPECT_LE(error, result.step_error_max + 2e-6) << "the marched value is good to about 1e-6";
      EXPECT_LT(result.step_error_max, tolerance + 1e-6);
      EXPECT_LE(error, before + 2e-6) << "halving the tolerance never makes it worse";
      EXPECT_EQ(result.unconverged_share, 0.0);
      before = error;
    }
    EXPECT_LT(before, 5e-6);
  }
}

TEST(ReferencePicture, TooFewStepsAreCounted) {
  const Scene scene = lit_scene();
  // Close past the lamp, so that 1/r² is steep.
  const Camera camera = camera_at({0.4F, 0.3F, 4}, {0.4F, 0.3001F, 0}, 1, 1);
  const SurfaceLayer black = flat_surfaces(camera, glm::vec3(0), kInfinity);
  ReferenceOptions options;
  options.min_steps = 1;
  options.max_steps = 16;
  const Reference result = render_reference(scene, camera, black, options);
  EXPECT_EQ(result.unconverged_share, 1.0);
  EXPECT_GT(result.step_error_max, options.tolerance);
}

TEST(ReferencePicture, TurningEverythingChangesNothing) {
  Scene scene = lit_scene();
  Camera camera = camera_at({2, 1.5F, 3}, {0.1F, 0, 0}, 8, 6);
  const SurfaceLayer surfaces = flat_surfaces(camera, {0.2F, 0.1F, 0.4F}, kInfinity);
  ReferenceOptions options;
  options.tolerance = 1e-7;
  const Reference straight = render_reference(scene, camera, surfaces, options);

  const glm::mat4 turn = glm::rotate(glm::translate(glm::mat4(1.0F), {3, -1, 2}), 1.1F, {0.3F, 1, -0.4F});
  const auto point = [&](const glm::vec3& p) { return glm::vec3(turn * glm::vec4(p, 1.0F)); };
  scene.volume->to_world = turn * scene.volume->to_world;
  for (Light& light : scene.lights) {
    light.position = point(light.position);
    light.direction = glm::mat3(turn) * light.direction;
  }
  camera.view.eye = point(camera.view.eye);
  camera.view.target = point(camera.view.target);
  camera.view.up = glm::mat3(turn) * camera.view.up;
  const Reference turned = render_reference(scene, camera, surfaces, options);
  double contrast = 0;
  for (std::size_t i = 0; i < straight.image.pixels.size(); ++i) {
    EXPECT_NEAR(straight.image.pixels[i], turned.image.pixels[i], 2e-5);
    contrast =
        std::max(contrast, static_cast<double>(std::abs(straight.image.pixels[i] - straight.image.pixels[i % 4])));
  }
  EXPECT_GT(contrast, 0.05) << "the picture has something to compare";
}

}  // namespace
}  // namespace pellucid
