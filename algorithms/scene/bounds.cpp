#include "algorithms/scene/bounds.hpp"

#include <limits>
#include <vector>

namespace pellucid {
namespace {

struct Grow {
  glm::vec3 min{std::numeric_limits<float>::max()};
  glm::vec3 max{std::numeric_limits<float>::lowest()};
  void add(const glm::vec3& p) {
    min = glm::min(min, p);
    max = glm::max(max, p);
  }
  void add_box(const glm::mat4& to_world, const glm::vec3& low, const glm::vec3& high) {
    for (int i = 0; i < 8; ++i) {
      const glm::vec3 corner((i & 1) != 0 ? high.x : low.x, (i & 2) != 0 ? high.y : low.y,
                             (i & 4) != 0 ? high.z : low.z);
      add(glm::vec3(to_world * glm::vec4(corner, 1.0F)));
    }
  }
};

}  // namespace

Bounds world_bounds(const Scene& scene) {
  // Each mesh once, however often it is placed.
  std::vector<Grow> meshes(scene.meshes.size());
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    for (const glm::vec3& p : scene.meshes[m].positions)
      meshes[m].add(p);
  }
  Grow world;
  for (const Instance& instance : scene.instances) {
    const Grow& mesh = meshes[static_cast<std::size_t>(instance.mesh)];
    if (mesh.min.x <= mesh.max.x) world.add_box(instance.to_world, mesh.min, mesh.max);
  }
  if (scene.volume) world.add_box(scene.volume->to_world, glm::vec3(0.0F), glm::vec3(1.0F));
  if (world.min.x > world.max.x) return {};
  return {world.min, world.max};
}

}  // namespace pellucid
