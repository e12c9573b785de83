#pragma once

#include <string>

#include "algorithms/local_cube_maps/settings.hpp"
#include "algorithms/raster/cube_pass.hpp"

namespace pellucid::local_cube_maps {

/// A distance impostor: the environment of a reference point, its radiance and its distance [m] (Szirmay-Kalos et al.
/// 2005, Sec. 2).
class ImpostorCube {
 public:
  ImpostorCube(const std::string& label, const MapSettings&);

  /// Opaque objects and environment about the camera's centre.
  void draw(CubeScene&, const ForwardPass&, const CubeCamera&);
  /// For what is drawn over them: depth is kept, and the target has radiance and distance.
  const CubeTarget& target() const { return target_; }

  /// To the units that lookup.glsl reads.
  void bind() const;
  const gl::Texture& radiance() const { return radiance_; }
  /// Its alpha is the distance, whichever texture that is.
  const gl::Texture& distance() const { return distance_ ? distance_ : radiance_; }
  const gl::Texture& depth() const { return depth_; }

  const CubeCamera& camera() const { return camera_; }  ///< of the last draw()

 private:
  gl::Texture radiance_, distance_, depth_;
  CubeTarget target_;
  CubeCamera camera_;
};

}  // namespace pellucid::local_cube_maps
