#pragma once

#include <glm/glm.hpp>

#include "algorithms/scene/relief/relief.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace pellucid::translucent_relief {

/// The transfer functions of a relief's scattering medium by depth, one table a channel (Chan and Wang 2005, Sec. 3.3,
/// as Timonen, Sec. 6, proposes): what scattering.glsl reads.
class Transfer {
 public:
  /// Makes the table when the medium has changed.
  void update(const Relief&);
  /// Binds it and sets the extinction.
  void bind(const Relief&, const gl::Program&) const;

 private:
  glm::vec3 scattering_{-1.0F}, absorption_{0.0F};
  float anisotropy_ = 0;
  gl::Texture table_;
};

}  // namespace pellucid::translucent_relief
