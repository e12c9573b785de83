#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <unordered_map>
#include <vector>

#include "algorithms/scene/meshes/mesh_file.hpp"

namespace pellucid {

namespace {

/// Beyond this many triangles around one point (the tip of a fan), all of them are smoothed: the search below takes the
/// square of their number.
constexpr std::size_t kMaxCompared = 512;

struct PositionHash {
  std::size_t operator()(const glm::vec3& p) const {
    std::uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float value = p[axis] + 0.0F;  // −0 is equal to 0
      std::uint32_t bits = 0;
      std::memcpy(&bits, &value, sizeof bits);
      hash = (hash ^ bits) * 0x9e3779b97f4a7c15ULL;
      hash ^= hash >> 29;
    }
    return hash;
  }
};

/// The triangles around each distinct point; vertices at one point share them.
struct Neighbours {
  std::vector<std::uint32_t> point;  ///< of each vertex
  std::vector<std::uint32_t> begin;  ///< of each point's triangles in `triangles`, and one past the last
  std::vector<std::uint32_t> triangles;
};

Neighbours find_neighbours(const Mesh& mesh) {
  Neighbours result;
  std::unordered_map<glm::vec3, std::uint32_t, PositionHash> points;
  points.reserve(mesh.positions.size());
  for (const glm::vec3& p : mesh.positions) {
    result.point.push_back(points.emplace(p, static_cast<std::uint32_t>(points.size())).first->second);
  }
  result.begin.assign(points.size() + 1, 0);
  for (const glm::uvec3& t : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner)
      ++result.begin[result.point[t[corner]] + 1];
  }
  for (std::size_t i = 1; i < result.begin.size(); ++i)
    result.begin[i] += result.begin[i - 1];
  result.triangles.resize(mesh.triangles.size() * 3);
  std::vector<std::uint32_t> next(result.begin.begin(), result.begin.end() - 1);
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (int corner = 0; corner < 3; ++corner) {
      result.triangles[next[result.point[mesh.triangles[f][corner]]]++] = static_cast<std::uint32_t>(f);
    }
  }
  return result;
}

glm::dvec3 unit_or_up(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0 && std::isfinite(length) ? v / length : glm::dvec3(0, 1, 0);  // a degenerate triangle is never seen
}

}  // namespace

void make_normals(Mesh& mesh, double crease_deg, std::span<const std::uint32_t> groups) {
  const Neighbours around = find_neighbours(mesh);
  std::vector<glm::dvec3> area_normals;  // length: twice the triangle's area
  std::vector<glm::dvec3> unit_normals;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.x]);
    area_normals.push_back(glm::cross(glm::dvec3(mesh.positions[t.y]) - a, glm::dvec3(mesh.positions[t.z]) - a));
    unit_normals.push_back(unit_or_up(area_normals.back()));
  }
  const double least_cosine = crease_deg >= 180 ? -2 : std::cos(glm::radians(crease_deg));

  constexpr std::uint32_t kNone = 0xffffffff;
  std::vector<std::uint32_t> same_origin;  // of each vertex, the next one that was split off from the same vertex
  same_origin.assign(mesh.positions.size(), kNone);
  std::vector<bool> used(mesh.positions.size(), false);
  mesh.normals.assign(mesh.positions.size(), glm::vec3(0, 1, 0));

  const auto vertex_with = [&](std::uint32_t vertex, const glm::vec3& normal) {
    if (!used[vertex]) {
      used[vertex] = true;
      mesh.normals[vertex] = normal;
      return vertex;
    }
    std::uint32_t last = vertex;
    for (std::uint32_t v = vertex; v != kNone; v = same_origin[v]) {
      if (mesh.normals[v] == normal) return v;
      last = v;
    }
    const auto split = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(glm::vec3(mesh.positions[vertex]));
    mesh.normals.push_back(normal);
    if (!mesh.colors.empty()) mesh.colors.push_back(glm::vec3(mesh.colors[vertex]));
    if (!mesh.uvs.empty()) mesh.uvs.push_back(glm::vec2(mesh.uvs[vertex]));
    same_origin.push_back(kNone);
    used.push_back(true);
    same_origin[last] = split;
    return split;
  };

  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    glm::uvec3& triangle = mesh.triangles[f];
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t point = around.point[triangle[corner]];
      const std::uint32_t begin = around.begin[point];
      const std::uint32_t end = around.begin[point + 1];
      const bool all = end - begin > kMaxCompared;
      // The mean of the neighbours' normals, weighted by area; always in the same order, so equal sets give equal
      // normals.
      glm::dvec3 sum(0.0);
      for (std::uint32_t i = begin; i < end; ++i) {
        const std::uint32_t g = around.triangles[i];
        const bool together =
            groups.empty() ? glm::dot(unit_normals[f], unit_normals[g]) >= least_cosine : (groups[f] & groups[g]) != 0;
        if (all || g == f || together) sum += area_normals[g];
      }
      const double length = glm::length(sum);
      const glm::dvec3 normal = length > 1e-12 * glm::length(area_normals[f]) ? unit_or_up(sum) : unit_normals[f];
      triangle[corner] = vertex_with(triangle[corner], glm::vec3(normal));
    }
  }
}

}  // namespace pellucid
