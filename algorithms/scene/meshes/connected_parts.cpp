#include "algorithms/scene/meshes/connected_parts.hpp"

#include <numeric>

#include <glm/glm.hpp>

namespace pellucid {

ConnectedParts connected_parts(const Mesh& mesh) {
  std::vector<unsigned> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](unsigned v) {
    while (parent[v] != v)
      v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const glm::uvec3& t : mesh.triangles) {
    parent[root(t.y)] = root(t.x);
    parent[root(t.z)] = root(t.x);
  }
  ConnectedParts parts;
  std::vector<int> number(mesh.positions.size(), -1);
  for (unsigned v = 0; v < parent.size(); ++v) {
    int& n = number[root(v)];
    if (n < 0) n = parts.count++;
    parts.of_vertex.push_back(n);
  }
  return parts;
}

}  // namespace pellucid
