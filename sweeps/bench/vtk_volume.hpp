#pragma once

#include <memory>

#include "algorithms/scene/images/image.hpp"
#include "algorithms/scene/scene.hpp"

namespace pellucid::sweeps {

/// A volume drawn by VTK's GPU ray caster (vtkOpenGLGPUVolumeRayCastMapper) over black into a frame of 32-bit floats:
/// one colour, white, unshaded; the extinction becomes VTK's opacity per unit distance, through the transfer function
/// if there is one. Voxels are VTK's cells, so that density is interpolated and clamped at the border as ours is.
class VtkVolume {
 public:
  /// Draws in the GL context that is current, which must be its own for as long as it lives, since VTK leaves state
  /// behind. Throws RuntimeError with the reason when VTK cannot draw the volume.
  VtkVolume(const Volume&, const Camera&);
  ~VtkVolume();
  VtkVolume(const VtkVolume&) = delete;
  VtkVolume& operator=(const VtkVolume&) = delete;

  /// The distance between two points on a ray.
  void set_sample_distance(double metres);
  void render();
  Image read_color() const;  ///< RGB, rows from the top

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pellucid::sweeps
