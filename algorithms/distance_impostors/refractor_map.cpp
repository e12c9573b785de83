#include "algorithms/distance_impostors/refractor_map.hpp"

#include <span>
#include <vector>

namespace pellucid::distance_impostors {
namespace {

struct Vertex {
  glm::vec3 position, normal, color;
};
// What cube.vert.glsl takes of an instance; here it changes nothing.
struct Unmoved {
  glm::mat4 to_world{1.0F};
  glm::vec3 normal_to_world[3]{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  glm::vec3 albedo{0.0F}, emission{0.0F};
};

}  // namespace

RefractorMap::RefractorMap(const Mesh& mesh, int size, CubeLayers layers)
    : center_(choose_center(mesh)),
      shape_(measure_star_shape(mesh, center_)),
      map_(gl::Texture::make_cube("refractor map of " + mesh.name, gl::Format::rgba32f, size)) {
  // One object alone leaves a vertex shader nothing to win.
  const CubeLayers pass = layers == CubeLayers::vertex ? CubeLayers::geometry : layers;
  std::vector<Vertex> vertices(mesh.positions.size());
  float reach = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    vertices[i] = {mesh.positions[i], mesh.normals[i], glm::vec3(1)};
    reach = std::max(reach, glm::distance(mesh.positions[i], center_));
  }
  map_.set_sampling(gl::Filter::linear, gl::Wrap::clamp);
  if (vertices.empty() || !(reach > 0)) {
    map_.clear({0, 0, 0, 1});
    return;
  }
  const gl::Buffer vertex_buffer("refractor vertices", std::span<const Vertex>(vertices));
  const gl::Buffer index_buffer("refractor indices", std::span<const glm::uvec3>(mesh.triangles));
  const Unmoved unmoved;
  const gl::Buffer instance("refractor instance", std::span<const Unmoved>(&unmoved, 1));
  gl::VertexArray array(
      "refractor", vertex_buffer, sizeof(Vertex),
      {{0, 3, offsetof(Vertex, position)}, {1, 3, offsetof(Vertex, normal)}, {2, 3, offsetof(Vertex, color)}},
      &index_buffer);
  const std::size_t normals = offsetof(Unmoved, normal_to_world);
  array.add_instanced(instance, sizeof(Unmoved),
                      {{3, 4, 0},
                       {4, 4, sizeof(glm::vec4)},
                       {5, 4, 2 * sizeof(glm::vec4)},
                       {6, 4, 3 * sizeof(glm::vec4)},
                       {7, 3, normals},
                       {8, 3, normals + sizeof(glm::vec3)},
                       {9, 3, normals + 2 * sizeof(glm::vec3)},
                       {10, 3, offsetof(Unmoved, albedo)},
                       {11, 3, offsetof(Unmoved, emission)}});
  const gl::Texture depth = gl::Texture::make_cube("refractor depth", gl::Format::depth32f, size);
  const CubeTarget target("refractor", {&map_}, &depth);
  const CubeCamera camera{center_, 1e-3F * reach, 1.05F * reach, pass};
  const gl::Program program =
      make_cube_program("refractor map", "algorithms/distance_impostors/refractor.frag.glsl", pass, {});
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_TRUE);
  // Where there is no surface, the farthest stands in; the shader takes the direction for its normal.
  map_.clear({0, 0, 0, reach});
  target.draw(pass, [&](int face) {
    const float far_depth = 1.0F;
    glClearBufferfv(GL_DEPTH, 0, &far_depth);
    use_cube_program(program, camera, face);
    array.bind();
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(mesh.triangles.size() * 3), GL_UNSIGNED_INT, nullptr);
  });
}

}  // namespace pellucid::distance_impostors
