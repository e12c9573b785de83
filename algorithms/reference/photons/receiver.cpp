#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "algorithms/reference/photons/photons.hpp"
#include "gl/error.hpp"

namespace pellucid {
namespace {

// How far a vertex may lie from the plane and from its place in the map, as a share of the rectangle's size.
constexpr double kFlat = 1e-4;

double area(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c) {
  const glm::dvec2 ab(b - a), ac(c - a);
  return std::abs(ab.x * ac.y - ab.y * ac.x);
}

}  // namespace

Receiver receiver_of(const Scene& scene, int instance, int width, int height) {
  const Instance& object = scene.instances.at(static_cast<std::size_t>(instance));
  const Mesh& mesh = scene.meshes[static_cast<std::size_t>(object.mesh)];
  const auto refuse = [&](const char* why) {
    return InputError(fmt::format("instance '{}' cannot receive a light map: {}", object.name, why));
  };
  if (mesh.uvs.empty()) throw refuse("its mesh has no texture coordinates");
  const glm::uvec3* widest = nullptr;
  double most = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const double covered = area(mesh.uvs[t.x], mesh.uvs[t.y], mesh.uvs[t.z]);
    if (covered > most) {
      most = covered;
      widest = &t;
    }
  }
  if (widest == nullptr) throw refuse("its texture coordinates cover no area");

  const auto placed = [&](unsigned i) {
    return glm::dvec3(glm::dmat4(object.to_world) * glm::dvec4(glm::dvec3(mesh.positions[i]), 1.0));
  };
  // The map (u, v) → place is affine: three corners of the widest triangle fix it.
  const glm::dvec2 a(mesh.uvs[widest->x]), ab = glm::dvec2(mesh.uvs[widest->y]) - a,
                                           ac = glm::dvec2(mesh.uvs[widest->z]) - a;
  const glm::dvec3 p = placed(widest->x), pb = placed(widest->y) - p, pc = placed(widest->z) - p;
  const double determinant = ab.x * ac.y - ab.y * ac.x;
  Receiver receiver;
  receiver.name = object.name;
  receiver.edge_u = (ac.y * pb - ab.y * pc) / determinant;
  receiver.edge_v = (ab.x * pc - ac.x * pb) / determinant;
  receiver.origin = p - a.x * receiver.edge_u - a.y * receiver.edge_v;
  receiver.width = width;
  receiver.height = height;
  receiver.instance = instance;
  const double size = glm::length(receiver.edge_u) + glm::length(receiver.edge_v);
  for (unsigned i = 0; i < mesh.positions.size(); ++i) {
    const glm::dvec2 uv(mesh.uvs[i]);
    const glm::dvec3 there = receiver.origin + uv.x * receiver.edge_u + uv.y * receiver.edge_v;
    if (glm::distance(there, placed(i)) > kFlat * size)
      throw refuse("it is not flat, or its texture coordinates do not change evenly over it");
  }
  return receiver;
}

}  // namespace pellucid
