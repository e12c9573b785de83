#include "algorithms/scene/meshes/tangents.hpp"

#include <cmath>
#include <cstddef>
#include <string>

#include <fmt/format.h>

#include "gl/error.hpp"

namespace pellucid {

Tangents tangents_of(const Mesh& mesh, const std::string& what) {
  if (mesh.uvs.empty()) {
    throw InputError(
        fmt::format("{} has no texture coordinates, so that no relief can lie on it (mesh '{}')", what, mesh.name));
  }
  Tangents tangents{std::vector<glm::vec3>(mesh.positions.size(), glm::vec3(0.0F)),
                    std::vector<glm::vec3>(mesh.positions.size(), glm::vec3(0.0F))};
  std::vector<float> weights(mesh.positions.size(), 0.0F);
  std::vector<bool> used(mesh.positions.size(), false);
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::vec3 ab = mesh.positions[t.y] - mesh.positions[t.x], ac = mesh.positions[t.z] - mesh.positions[t.x];
    const glm::vec2 uv_ab = mesh.uvs[t.y] - mesh.uvs[t.x], uv_ac = mesh.uvs[t.z] - mesh.uvs[t.x];
    used[t.x] = used[t.y] = used[t.z] = true;
    const float det = uv_ab.x * uv_ac.y - uv_ab.y * uv_ac.x;
    if (std::abs(det) < 1e-12F) continue;
    const float weight = glm::length(glm::cross(ab, ac));
    const glm::vec3 u = (ab * uv_ac.y - ac * uv_ab.y) / det, v = (ac * uv_ab.x - ab * uv_ac.x) / det;
    for (int corner = 0; corner < 3; ++corner) {
      tangents.u[t[corner]] += weight * u;
      tangents.v[t[corner]] += weight * v;
      weights[t[corner]] += weight;
    }
  }
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (!used[i]) continue;
    if (weights[i] > 0.0F) {
      tangents.u[i] /= weights[i];
      tangents.v[i] /= weights[i];
    }
    const glm::vec3& n = mesh.normals[i];
    const glm::vec3 u = tangents.u[i] - n * glm::dot(n, tangents.u[i]);
    if (!(glm::length(u) > 0.0F) || glm::dot(glm::cross(n, u), tangents.v[i]) == 0.0F) {
      throw InputError(fmt::format(
          "{}: the texture coordinates around vertex {} of mesh '{}' span no area, so that it has no tangents", what, i,
          mesh.name));
    }
  }
  return tangents;
}

}  // namespace pellucid
