#include "algorithms/raster/object_vertices.hpp"

#include <cstddef>
#include <utility>

namespace pellucid {

gl::VertexArray make_object_array(std::string label, const gl::Buffer& vertices, const gl::Buffer& indices,
                                  const gl::Buffer& instances) {
  gl::VertexArray array(std::move(label), vertices, sizeof(ObjectVertex),
                        {{0, 3, offsetof(ObjectVertex, position)},
                         {1, 3, offsetof(ObjectVertex, normal)},
                         {2, 3, offsetof(ObjectVertex, color)}},
                        &indices);
  const std::size_t normals = offsetof(InstanceAttributes, normal_to_world);
  array.add_instanced(instances, sizeof(InstanceAttributes),
                      {{3, 4, 0},
                       {4, 4, sizeof(glm::vec4)},
                       {5, 4, 2 * sizeof(glm::vec4)},
                       {6, 4, 3 * sizeof(glm::vec4)},
                       {7, 3, normals},
                       {8, 3, normals + sizeof(glm::vec3)},
                       {9, 3, normals + 2 * sizeof(glm::vec3)},
                       {10, 3, offsetof(InstanceAttributes, albedo)},
                       {11, 3, offsetof(InstanceAttributes, emission)}});
  return array;
}

}  // namespace pellucid
