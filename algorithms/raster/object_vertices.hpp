#pragma once

#include <string>

#include <glm/glm.hpp>

#include "gl/objects.hpp"

/// The attributes that opaque.vert.glsl and cube.vert.glsl take.
namespace pellucid {

struct ObjectVertex {
  glm::vec3 position, normal, color{1.0F};
};

/// The attributes of an instance; by default they change nothing.
struct InstanceAttributes {
  glm::mat4 to_world{1.0F};
  glm::vec3 normal_to_world[3]{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  glm::vec3 albedo{0.0F}, emission{0.0F};
};

/// The vertex array over a buffer of ObjectVertex, one of a mesh's triangles, and one of InstanceAttributes.
gl::VertexArray make_object_array(std::string label, const gl::Buffer& vertices, const gl::Buffer& indices,
                                  const gl::Buffer& instances);

}  // namespace pellucid
