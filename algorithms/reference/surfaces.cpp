#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <optional>

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include "algorithms/reference/geometry.hpp"
#include "algorithms/reference/reference.hpp"
#include "algorithms/reference/shading.hpp"

namespace pellucid {
namespace {

glm::dvec3 interpolate(const std::vector<glm::vec3>& values, const Hit& hit) {
  return hit.weights.x * glm::dvec3(values[hit.triangle.x]) + hit.weights.y * glm::dvec3(values[hit.triangle.y]) +
         hit.weights.z * glm::dvec3(values[hit.triangle.z]);
}

// What is seen at a pixel, ready to be lit.
struct SurfacePoint {
  glm::dvec3 position{0.0};
  glm::dvec3 normal{0.0};  // unit, turned to the viewer
  glm::dvec3 albedo{0.0}, emission{0.0};
  double distance = 0.0;  // from the eye
};

SurfacePoint surface_at(const Scene& scene, const Hit& hit, const glm::dvec3& origin, const glm::dvec3& direction) {
  const Instance& instance = *hit.instance;
  const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
  const Material& material = scene.materials[static_cast<std::size_t>(instance.material)];
  SurfacePoint point;
  point.distance = hit.distance;
  point.position = origin + hit.distance * direction;
  const glm::dmat3 normal_to_world = glm::transpose(glm::inverse(glm::dmat3(instance.to_world)));
  point.normal = glm::normalize(normal_to_world * interpolate(mesh.normals, hit));
  // Two-sided: the triangle's own normal tells which side is seen; at a smooth silhouette the interpolated one may not.
  const auto corner = [&](glm::length_t i) { return glm::dvec3(mesh.positions[hit.triangle[i]]); };
  glm::dvec3 geometric = normal_to_world * glm::cross(corner(1) - corner(0), corner(2) - corner(0));
  if (glm::dot(geometric, direction) > 0.0) geometric = -geometric;
  if (glm::dot(point.normal, geometric) < 0.0) point.normal = -point.normal;
  point.albedo = glm::dvec3(material.albedo) * glm::dvec3(instance.tint);
  if (!mesh.colors.empty()) point.albedo *= interpolate(mesh.colors, hit);
  point.emission = glm::dvec3(material.emission);
  return point;
}

// Lights a point with exact shadows. `geometry` null: no light casts one.
glm::dvec3 shade(const Illumination& light, const Geometry* geometry, const SurfacePoint& point) {
  // Embree's ray starts at the position rounded to single precision, and a raster position errs by as much again, so
  // it sets out this far above the surface: some hundred roundings of the coordinates that went into it.
  const glm::dvec3 size = glm::abs(point.position);
  const double clearance = 1e-5 * (point.distance + std::max({size.x, size.y, size.z}));
  const glm::dvec3 start = point.position + clearance * point.normal;
  return light.surface_radiance(point.position, point.normal, point.albedo, point.emission,
                                [&](std::size_t index, const Incidence& in) {
                                  return geometry == nullptr || !light.casts_shadow(index) ||
                                         !geometry->occluded(start, in.to_light, 0.0, in.distance * (1.0 - 1e-6));
                                });
}

void write(float* pixel, const glm::dvec3& radiance) {
  for (int c = 0; c < 3; ++c)
    pixel[c] = static_cast<float>(radiance[c]);
}

glm::dvec3 read(const float* pixel) {
  return {static_cast<double>(pixel[0]), static_cast<double>(pixel[1]), static_cast<double>(pixel[2])};
}

std::size_t pixel_index(const Camera& camera, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(x);
}

// Calls visit(x, y, direction through the pixel's centre) for all pixels, in parallel.
template <class F>
void for_pixels(const Camera& camera, F visit) {
  tbb::parallel_for(tbb::blocked_range2d<int>(0, camera.height, 16, 0, camera.width, 64), [&](const auto& tile) {
    for (int y = tile.rows().begin(); y < tile.rows().end(); ++y) {
      for (int x = tile.cols().begin(); x < tile.cols().end(); ++x)
        visit(x, y, camera.ray_direction(x + 0.5, y + 0.5));
    }
  });
}

}  // namespace

SurfaceLayer trace_surfaces(const Scene& scene, const Camera& camera) {
  assert(camera.width > 0 && camera.height > 0);
  const Geometry geometry(scene);
  const Illumination light(scene);
  SurfaceLayer layer;
  layer.radiance = Image(camera.width, camera.height, 3);
  layer.distance_m.resize(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  const glm::dvec3 origin(camera.view.eye);
  const glm::dvec3 forward = glm::normalize(glm::dvec3(camera.view.target) - origin);

  for_pixels(camera, [&](int x, int y, const glm::dvec3& direction) {
    // The clipping planes are at constant view depth.
    const double per_depth = 1.0 / glm::dot(direction, forward);
    const Hit hit = geometry.intersect(origin, direction, static_cast<double>(camera.view.near_m) * per_depth,
                                       static_cast<double>(camera.view.far_m) * per_depth);
    write(layer.radiance.at(x, y), hit.instance != nullptr
                                       ? shade(light, &geometry, surface_at(scene, hit, origin, direction))
                                       : glm::dvec3(scene.environment.radiance(glm::vec3(direction))));
    layer.distance_m[pixel_index(camera, x, y)] = hit.distance;
  });
  return layer;
}

SurfaceLayer shade_surfaces(const Scene& scene, const Camera& camera, const SurfacePoints& points) {
  assert(points.distance_m.size() == static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  for ([[maybe_unused]] const Image* image : {&points.albedo, &points.normal, &points.emission})
    assert(image->width == camera.width && image->height == camera.height && image->channels >= 3);

  const Illumination light(scene);
  std::optional<Geometry> geometry;
  for (const Light& emitter : scene.lights) {
    if (emitter.casts_shadow && !geometry) geometry.emplace(scene);
  }
  SurfaceLayer layer;
  layer.radiance = Image(camera.width, camera.height, 3);
  layer.distance_m = points.distance_m;
  const glm::dvec3 origin(camera.view.eye);
  for_pixels(camera, [&](int x, int y, const glm::dvec3& direction) {
    SurfacePoint point;
    point.distance = points.distance_m[pixel_index(camera, x, y)];
    if (std::isinf(point.distance)) {
      write(layer.radiance.at(x, y), glm::dvec3(scene.environment.radiance(glm::vec3(direction))));
      return;
    }
    point.position = origin + point.distance * direction;
    point.normal = read(points.normal.at(x, y));
    point.albedo = read(points.albedo.at(x, y));
    point.emission = read(points.emission.at(x, y));
    write(layer.radiance.at(x, y), shade(light, geometry ? &*geometry : nullptr, point));
  });
  return layer;
}

}  // namespace pellucid
