#pragma once

#include <functional>
#include <string>

#include "algorithms/raster/forward_pass.hpp"
#include "algorithms/scene/scene.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace pellucid::translucent_relief {

/// Light that the medium's waves gather on the solid, from directional lights under a flat mesh: maps over the relief's
/// maps, one for each light, of its irradiance on a level plane relative to that without a medium. Timonen, Sec. 4.1,
/// says that the paper's light occlusion cannot have them.
class Caustics {
 public:
  /// Draws the maps. `set_uniforms` sets those of light_reaching.glsl, and its maps, for a program. InputError: the
  /// mesh is not flat.
  void update(const Scene&, const Instance&, int resolution, const gl::Defines&,
              const std::function<void(const gl::Program&)>& set_uniforms);
  void bind() const { maps_.bind(13); }
  std::string reload_shaders() { return program_ ? program_.reload() : std::string(); }

 private:
  gl::Program program_;
  gl::Defines defines_;
  gl::Texture maps_;
  gl::VertexArray grid_;
};

}  // namespace pellucid::translucent_relief
