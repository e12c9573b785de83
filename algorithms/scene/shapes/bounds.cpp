#include "algorithms/scene/shapes/bounds.hpp"

#include <cstddef>
#include <limits>
#include <vector>

namespace pellucid {
namespace {

struct Grow {
  Bounds box{glm::vec3(std::numeric_limits<float>::max()), glm::vec3(std::numeric_limits<float>::lowest())};
  void add(const glm::vec3& p) {
    box.min = glm::min(box.min, p);
    box.max = glm::max(box.max, p);
  }
  void add(const glm::mat4& to_world, const Bounds& bounds) {
    for (int i = 0; i < 8; ++i)
      add(glm::vec3(to_world * glm::vec4(bounds.corner(i), 1.0F)));
  }
  Bounds result() const { return box.min.x <= box.max.x ? box : Bounds{}; }
};

}  // namespace

Bounds mesh_bounds(const Mesh& mesh) {
  Grow grown;
  for (const glm::vec3& p : mesh.positions)
    grown.add(p);
  return grown.result();
}

Bounds world_bounds(const Scene& scene) {
  // Each mesh once, however often it is placed.
  std::vector<Bounds> meshes;
  for (const Mesh& mesh : scene.meshes)
    meshes.push_back(mesh_bounds(mesh));
  Grow world;
  for (const Instance& instance : scene.instances) {
    const auto mesh = static_cast<std::size_t>(instance.mesh);
    if (!scene.meshes[mesh].positions.empty()) world.add(instance.to_world, meshes[mesh]);
  }
  if (scene.volume) world.add(scene.volume->to_world, {glm::vec3(0.0F), glm::vec3(1.0F)});
  return world.result();
}

}  // namespace pellucid
