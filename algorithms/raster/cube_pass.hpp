#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/raster/forward_pass.hpp"
#include "gl/cube_faces.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

/// The scene as seen from a point all around, into a cube map in the world's axes.
namespace pellucid {

/// How triangles reach the faces.
enum class CubeLayers {
  geometry,  ///< one traversal, a geometry shader sends each triangle to the faces that may see it
  vertex,    ///< one traversal, each object drawn six times in one call, the vertex shader choosing the face
  faces      ///< six traversals, each with the objects that its face sees
};
/// True if a vertex shader of this device may choose the layer. A context must be current.
bool vertex_shader_chooses_layers();

struct CubeCamera {
  glm::vec3 center{0.0F};
  float near_m = 0.01F, far_m = 100.0F;
  CubeLayers layers = CubeLayers::geometry;
  /// Sees all of the scene from `center`.
  static CubeCamera around(const Scene&, const glm::vec3& center, CubeLayers);
};

/// A program of `fragment` behind the vertex stages of a pass over a cube's faces. The fragment shader gets what
/// opaque.vert.glsl gives, and the reference point as `eye`.
gl::Program make_cube_program(const std::string& label, const std::string& fragment, CubeLayers, gl::Defines);

/// Cube maps drawn together, of one size; it does not own them.
class CubeTarget {
 public:
  CubeTarget() = default;
  CubeTarget(const std::string& label, std::initializer_list<const gl::Texture*> colors, const gl::Texture* depth);

  /// Calls `draw(face)` with the framebuffer bound: once with −1, or for each face.
  template <class Draw>
  void draw(CubeLayers layers, Draw&& draw) const {
    if (layers != CubeLayers::faces) {
      all_.bind();
      draw(-1);
      return;
    }
    for (int face = 0; face < gl::kCubeFaces; ++face) {
      faces_[static_cast<std::size_t>(face)].bind();
      draw(face);
    }
  }

 private:
  gl::Framebuffer all_;
  std::vector<gl::Framebuffer> faces_;
};

/// Makes it the program in use and sets its transforms and `eye`; `face` as CubeTarget::draw() gives it.
void use_cube_program(const gl::Program&, const CubeCamera&, int face);

/// With `program` from make_cube_program(); `face` as CubeTarget::draw() gives it. Depth, blending and culling are as
/// the caller has set them.
void draw_cube_objects(const ForwardPass&, const CubeCamera&, int face, const gl::Program&, Objects);
void draw_cube_object(const ForwardPass&, const Scene&, int instance, const CubeCamera&, int face, const gl::Program&);

/// The environment and the shaded opaque objects with their distance from the centre.
class CubeScene {
 public:
  /// Where the distance [m] goes: into a second colour, or into the first one's alpha.
  enum class Distance { own, alpha };

  /// Clears and fills radiance, distance and depth. The environment counts as `sky_distance_m` away.
  void draw(const ForwardPass&, const CubeCamera&, const CubeTarget&, Distance, float sky_distance_m);
  std::string reload_shaders();

 private:
  gl::Program opaque_, sky_;
  gl::Defines opaque_defines_, sky_defines_;
  CubeLayers layers_ = CubeLayers::geometry;
  gl::VertexArray strip_;
};

}  // namespace pellucid
