#include "algorithms/local_cube_maps/refractor_map.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "algorithms/raster/object_vertices.hpp"

namespace pellucid::local_cube_maps {

RefractorMap::RefractorMap(const Mesh& mesh, int size, CubeLayers layers)
    : center_(choose_center(mesh)),
      shape_(measure_star_shape(mesh, center_)),
      map_(gl::Texture::make_cube("refractor map of " + mesh.name, gl::Format::rgba32f, size)) {
  // One object alone leaves a vertex shader nothing to win.
  const CubeLayers pass = layers == CubeLayers::vertex ? CubeLayers::geometry : layers;
  std::vector<ObjectVertex> vertices(mesh.positions.size());
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
  const gl::Buffer vertex_buffer("refractor vertices", std::span<const ObjectVertex>(vertices));
  const gl::Buffer index_buffer("refractor indices", std::span<const glm::uvec3>(mesh.triangles));
  const InstanceAttributes unmoved;
  const gl::Buffer instance("refractor instance", std::span<const InstanceAttributes>(&unmoved, 1));
  const gl::VertexArray array = make_object_array("refractor", vertex_buffer, index_buffer, instance);
  const gl::Texture depth = gl::Texture::make_cube("refractor depth", gl::Format::depth32f, size);
  const CubeTarget target("refractor", {&map_}, &depth);
  const CubeCamera camera{center_, 1e-3F * reach, 1.05F * reach, pass};
  const gl::Program program =
      make_cube_program("refractor map", "algorithms/local_cube_maps/refractor.frag.glsl", pass, {});
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

}  // namespace pellucid::local_cube_maps
