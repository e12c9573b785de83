#include "algorithms/reference/surface_point.hpp"

#include <cstddef>
#include <vector>

namespace pellucid {
namespace {

glm::dvec3 interpolate(const std::vector<glm::vec3>& values, const Hit& hit) {
  return hit.weights.x * glm::dvec3(values[hit.triangle.x]) + hit.weights.y * glm::dvec3(values[hit.triangle.y]) +
         hit.weights.z * glm::dvec3(values[hit.triangle.z]);
}

}  // namespace

SurfacePoint surface_at(const Scene& scene, const Geometry& geometry, const Hit& hit, const glm::dvec3& origin,
                        const glm::dvec3& direction) {
  const Instance& instance = *hit.instance;
  const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
  const Material& material = material_of(scene, instance);
  SurfacePoint point;
  point.distance = hit.distance;
  point.position = origin + hit.distance * direction;
  // Two-sided: the triangle's own normal tells which side is seen; at a smooth silhouette the interpolated one may not.
  const glm::dmat3& normal_to_world = geometry.normal_to_world(hit.index);
  const auto corner = [&](glm::length_t i) { return glm::dvec3(mesh.positions[hit.triangle[i]]); };
  point.face = glm::normalize(normal_to_world * glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
  point.front = glm::dot(point.face, direction) <= 0.0;
  if (!point.front) point.face = -point.face;
  point.normal = normal_to_world * interpolate(mesh.normals, hit);
  const double length = glm::length(point.normal);
  point.normal = length > 0.0 ? point.normal / length : point.face;  // opposite normals may cancel
  if (glm::dot(point.normal, point.face) < 0.0) point.normal = -point.normal;
  point.albedo = glm::dvec3(material.albedo) * glm::dvec3(instance.tint);
  if (!mesh.colors.empty()) point.albedo *= interpolate(mesh.colors, hit);
  point.emission = glm::dvec3(material.emission);
  return point;
}

}  // namespace pellucid
