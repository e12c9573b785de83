#pragma once

#include <string>

#include <glm/glm.hpp>

#include "algorithms/raster/pixel_area.hpp"
#include "algorithms/scene/scene.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace pellucid::local_cube_maps {

/// Which surface of an optical object each pixel shows. A rasteriser shades whole blocks of pixels for each triangle,
/// and those of a finely tessellated object are no larger than a pixel: so a first pass keeps the surfaces, and a
/// second one follows light once a pixel, and not at all for what another object hides.
class ObjectPixels {
 public:
  /// For surfaces before what `depth` holds, which is written too.
  void begin(const gl::Texture& depth);
  void clear(const PixelArea&) const;
  /// The first pass's program, behind opaque.vert.glsl; `number` > 0 tells which object it is.
  const gl::Program& surfaces(const Camera&, int number);

  /// The attributes that a program of the second pass reads (surface_point.glsl with FROM_PIXELS), behind
  /// fullscreen.vert.glsl.
  void bind(const gl::Program&, const Camera&, int number) const;
  /// Runs the program in use where the bound framebuffer's depth is not beyond the area.
  void fill(const PixelArea&) const;

  std::string reload_shaders() { return surfaces_ ? surfaces_.reload() : std::string(); }

 private:
  gl::Texture pixels_;
  gl::Framebuffer framebuffer_;
  gl::Program surfaces_;
  gl::VertexArray fullscreen_;
};

}  // namespace pellucid::local_cube_maps
