#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "algorithms/reference/reference.hpp"
#include "algorithms/scene/noise.hpp"
#include "algorithms/scene/scene.hpp"

/// The tests of the reference share this: small scenes, and ways of their own to the same numbers.
namespace pellucid::test {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kFloatRounding = 0x1p-23;

inline Volume box_volume(const glm::ivec3& size, std::vector<float> density, const glm::mat4& to_world) {
  Volume volume;
  volume.size = size;
  volume.density = std::move(density);
  volume.to_world = to_world;
  return volume;
}

inline glm::mat4 box_from_to(const glm::vec3& low, const glm::vec3& high) {
  return glm::scale(glm::translate(glm::mat4(1.0F), low), high - low);
}

inline Camera camera_at(const glm::vec3& eye, const glm::vec3& target, int width, int height, float near_m = 0.01F) {
  Camera camera;
  camera.view.eye = eye;
  camera.view.target = target;
  camera.view.near_m = near_m;
  camera.width = width;
  camera.height = height;
  return camera;
}

inline SurfaceLayer flat_surfaces(const Camera& camera, const glm::vec3& radiance, double distance_m) {
  SurfaceLayer layer;
  layer.radiance = Image(camera.width, camera.height, 3);
  for (std::size_t i = 0; i < layer.radiance.pixels.size(); ++i) {
    layer.radiance.pixels[i] = radiance[static_cast<int>(i % 3)];
  }
  layer.distance_m.assign(layer.radiance.pixels.size() / 3, distance_m);
  return layer;
}

// Trilinear density by its definition: voxel centres at (i + 1/2)/n, clamped at the border.
inline double density_at(const Volume& volume, const glm::dvec3& world) {
  const glm::dvec3 p =
      glm::dvec3(glm::inverse(glm::dmat4(volume.to_world)) * glm::dvec4(world, 1.0)) * glm::dvec3(volume.size) - 0.5;
  const glm::dvec3 base = glm::floor(p), f = p - base;
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    glm::ivec3 i;
    for (int axis = 0; axis < 3; ++axis) {
      const int up = (corner >> axis) & 1;
      weight *= up == 1 ? f[axis] : 1.0 - f[axis];
      i[axis] = std::clamp(static_cast<int>(base[axis]) + up, 0, volume.size[axis] - 1);
    }
    sum += weight * static_cast<double>(
                        volume.density[static_cast<std::size_t>((i.z * volume.size.y + i.y) * volume.size.x + i.x)]);
  }
  return sum;
}

inline double worst(const Image& image, const glm::dvec3& expected) {
  double error = 0;
  for (int c = 0; c < 3; ++c)
    error = std::max(error, std::abs(static_cast<double>(image.at(0, 0)[c]) - expected[c]));
  return error;
}

// ∫ f over [ends.front(), ends.back()], f smooth between neighbouring ends: Simpson's rule on each part.
template <class F>
auto quadrature(F f, std::vector<double> ends, int steps = 2000) {
  decltype(f(0.0)) sum = f(ends.front()) * 0.0;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const double h = (ends[i + 1] - ends[i]) / (2 * steps);
    // The ends from just inside, since f may jump there.
    const double inset = 1e-9 * (ends[i + 1] - ends[i]);
    decltype(sum) part = f(ends[i] + inset) + f(ends[i + 1] - inset);
    for (int k = 1; k < 2 * steps; ++k)
      part += f(ends[i] + k * h) * (k % 2 == 1 ? 4.0 : 2.0);
    sum += part * (h / 3.0);
  }
  return sum;
}

// The picture of one pixel through the middle of the view, in front of nothing.
inline Reference one_pixel(const Scene& scene, const glm::vec3& eye, const glm::vec3& target,
                           const ReferenceOptions& options = {}) {
  const Camera camera = camera_at(eye, target, 1, 1);
  return render_reference(scene, camera, flat_surfaces(camera, glm::vec3(0.0F), kInfinity), options);
}

inline glm::dvec3 radiance(const Reference& reference) {
  const float* pixel = reference.image.at(0, 0);
  return {static_cast<double>(pixel[0]), static_cast<double>(pixel[1]), static_cast<double>(pixel[2])};
}

inline void place(Scene& scene, Mesh mesh, const glm::mat4& to_world) {
  if (scene.materials.empty()) scene.materials.push_back({"m", glm::vec3(0.5F), glm::vec3(0.0F)});
  scene.instances.push_back({"i", static_cast<int>(scene.meshes.size()), 0, to_world, glm::vec3(1.0F)});
  scene.meshes.push_back(std::move(mesh));
}

inline double widened(float value) {
  return static_cast<double>(value);
}

// The ray along the x axis, from x = −2 on.
inline glm::dvec3 on_axis(double t) {
  return {t - 2.0, 0.0, 0.0};
}

inline void expect_near(const Reference& reference, const glm::dvec3& expected) {
  const glm::dvec3 seen = radiance(reference);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(seen[c], expected[c], 2e-7 * expected[c] + 1e-8) << "channel " << c;
}

inline Reference seen_along_x(const Scene& scene, double tolerance = 1e-8) {
  ReferenceOptions options;
  options.tolerance = tolerance;
  return one_pixel(scene, {-5, 0, 0}, {6, 0, 0}, options);
}

// A volume whose density crosses the function's kinks often.
inline Volume kinked_volume() {
  const glm::ivec3 size(4, 3, 5);
  std::vector<float> density(60);
  Random random(8);
  for (float& v : density)
    v = random.range(0.0F, 1.2F);
  Volume volume = box_volume(size, density, box_from_to({-2, -1, -2}, {6, 3, 2}));
  volume.extinction = 1.5F;
  volume.albedo = {0.9F, 0.5F, 1.0F};
  volume.transfer = {
      {0.2F, 0.0F, {1, 0, 0}}, {0.4F, 1.0F, {0.5F, 1, 0}}, {0.5F, 0.1F, {0, 1, 0.5F}}, {0.9F, 0.7F, {1, 1, 1}}};
  return volume;
}

struct Mapped {
  double extinction;
  glm::dvec3 albedo;
};

// The transfer function by its definition.
inline Mapped mapped(const Volume& volume, double density) {
  const std::vector<TransferPoint>& points = volume.transfer;
  std::size_t k = 0;
  while (k + 2 < points.size() && widened(points[k + 1].density) <= density)
    ++k;
  const double from = widened(points[k].density), to = widened(points[k + 1].density);
  const double u = std::clamp((density - from) / (to - from), 0.0, 1.0);
  return {widened(volume.extinction) * glm::mix(widened(points[k].extinction), widened(points[k + 1].extinction), u),
          glm::dvec3(volume.albedo) * glm::mix(glm::dvec3(points[k].albedo), glm::dvec3(points[k + 1].albedo), u)};
}

}  // namespace pellucid::test
