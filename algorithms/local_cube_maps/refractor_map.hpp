#pragma once

#include "algorithms/local_cube_maps/star_shape.hpp"
#include "algorithms/raster/cube_pass.hpp"
#include "algorithms/scene/scene.hpp"
#include "gl/objects.hpp"

namespace pellucid::local_cube_maps {

/// Distance of an object's surface from its centre, and the outward normal there, in every direction (Szirmay-Kalos et
/// al. 2005, Sec. 4), in 32-bit floats since refraction magnifies the error of a normal. Kept in the mesh's own space,
/// so that it is made once for a mesh, however it moves.
class RefractorMap {
 public:
  RefractorMap(const Mesh&, int size, CubeLayers);

  void bind() const { map_.bind(6); }
  const gl::Texture& texture() const { return map_; }
  const glm::vec3& center() const { return center_; }  ///< in the mesh's space
  const StarShape& shape() const { return shape_; }

 private:
  glm::vec3 center_{0.0F};
  StarShape shape_;
  gl::Texture map_;
};

}  // namespace pellucid::local_cube_maps
