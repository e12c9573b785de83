#pragma once

#include <functional>
#include <string>
#include <vector>

#include "algorithms/raster/forward_pass.hpp"
#include "algorithms/scene/scene.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace pellucid::translucent_relief {

/// Light that the medium's waves gather on the solid: maps over the mesh's texture, one for each light and layer of
/// charts, of the power that comes to a level plane at the solid's mean height. Timonen, Sec. 4.1, says that the
/// paper's light occlusion cannot have them.
class Caustics {
 public:
  /// Draws the maps. `set_uniforms` sets those of light_reaching.glsl, and its maps, for a program. InputError: as
  /// caustic_charts().
  void update(const Scene&, const Instance&, int resolution, const gl::Defines&,
              const std::function<void(const gl::Program&)>& set_uniforms);
  /// For relief.frag.glsl.
  void bind() const;
  std::string reload_shaders() { return program_ ? program_.reload() : std::string(); }

 private:
  void lay_out(const Scene&, const Instance&, int side, bool repeat);

  gl::Program program_;
  gl::Defines defines_;
  gl::Texture maps_, nodes_;
  gl::Buffer layer_of_triangle_;
  gl::VertexArray grid_;
  std::vector<glm::bvec2> closes_;  // by layer of charts
  bool repeat_ = false;
};

}  // namespace pellucid::translucent_relief
