#include "algorithms/reference/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pellucid {
namespace {

// A ray that leaves a surface sets out this far above it, as a share of its largest coordinate: some ten roundings of
// the single precision in which Embree takes it. Only the neighbours of its triangle need that; the triangle itself is
// left out by name.
constexpr double kClearance = 1e-6;

// Embree finds the triangle in single precision; where the ray meets it is solved again in double.
void refine(Hit& hit, const Mesh& mesh, const glm::dmat4& to_world, const glm::dvec3& origin,
            const glm::dvec3& direction, const embree::Hit& coarse) {
  const auto corner = [&](int i) {
    return glm::dvec3(to_world * glm::dvec4(glm::dvec3(mesh.positions[hit.triangle[i]]), 1.0));
  };
  const glm::dvec3 a = corner(0), ab = corner(1) - a, ac = corner(2) - a;
  const glm::dvec3 p = glm::cross(direction, ac);
  const double determinant = glm::dot(ab, p);
  const double scale = glm::length(ab) * glm::length(ac);
  if (std::abs(determinant) > 1e-9 * scale) {
    const glm::dvec3 from_a = origin - a, q = glm::cross(from_a, ab);
    const double u = glm::dot(from_a, p) / determinant, v = glm::dot(direction, q) / determinant;
    hit.weights = {1.0 - u - v, u, v};
    hit.distance = glm::dot(ac, q) / determinant;
  } else {  // edge-on: nothing to gain
    const double u = static_cast<double>(coarse.u), v = static_cast<double>(coarse.v);
    hit.weights = {1.0 - u - v, u, v};
    hit.distance = static_cast<double>(coarse.distance);
  }
}

}  // namespace

Geometry::Geometry(const Scene& scene, const std::function<bool(int)>& included)
    : scene_(&scene), device_(embree::make_device()), meshes_(scene.meshes.size()), root_(embree::empty_bvh(device_)) {
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    to_world_.emplace_back(instance.to_world);
    normals_.push_back(glm::transpose(glm::inverse(glm::dmat3(instance.to_world))));
    if (included && !included(static_cast<int>(i))) continue;
    const auto index = static_cast<std::size_t>(instance.mesh);
    const Mesh& mesh = scene.meshes[index];
    if (mesh.triangles.empty()) continue;
    if (!meshes_[index]) meshes_[index] = embree::triangles_bvh(device_, mesh.positions, mesh.triangles, mesh.name);
    embree::add_instance(device_, root_, meshes_[index], instance.to_world, static_cast<unsigned>(i));
  }
  embree::finish(device_, root_);
}

Hit Geometry::nearest(const glm::dvec3& embree_origin, const glm::dvec3& origin, const glm::dvec3& direction,
                      double begin, double end, float* met_at) const {
  const auto coarse = embree::nearest(root_, {embree_origin, direction, begin, end});
  if (!coarse) return {};

  if (met_at != nullptr) *met_at = coarse->distance;
  Hit hit;
  hit.index = static_cast<int>(coarse->instance);
  hit.instance = &scene_->instances[coarse->instance];
  const Mesh& mesh = scene_->meshes[static_cast<std::size_t>(hit.instance->mesh)];
  hit.primitive = coarse->triangle;
  hit.triangle = mesh.triangles[coarse->triangle];
  refine(hit, mesh, to_world_[coarse->instance], origin, direction, *coarse);
  return hit;
}

Hit Geometry::intersect(const glm::dvec3& origin, const glm::dvec3& direction, double begin, double end) const {
  return nearest(origin, origin, direction, begin, end);
}

Hit Geometry::intersect_from(const glm::dvec3& start, const Hit& from, const glm::dvec3& face,
                             const glm::dvec3& direction) const {
  const glm::dvec3 size = glm::abs(start);
  const glm::dvec3 raised = start + kClearance * std::max({size.x, size.y, size.z}) * face;
  float begin = 0.0F, met_at = 0.0F;
  for (;;) {
    Hit hit =
        nearest(raised, start, direction, static_cast<double>(begin), std::numeric_limits<double>::infinity(), &met_at);
    if (hit.instance == nullptr) return hit;
    if (hit.index != from.index || hit.primitive != from.primitive) {
      hit.distance = std::max(hit.distance, 0.0);
      return hit;
    }
    // Rounding in a large triangle. Embree takes numbers below the normal ones for 0.
    begin = std::nextafter(std::max(met_at, std::numeric_limits<float>::min()), std::numeric_limits<float>::infinity());
  }
}

bool Geometry::occluded(const glm::dvec3& origin, const glm::dvec3& direction, double begin, double end) const {
  return embree::occluded(root_, {origin, direction, begin, end});
}

}  // namespace pellucid
