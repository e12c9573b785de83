#pragma once

#include "algorithms/box_slicing.hpp"
#include "algorithms/scene/scene.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace pellucid {

/// A volume on the GPU, for programs that include shaders/common/medium.glsl.
class Medium {
 public:
  /// Uploads density and scattering as R16F and the transfer function as a table. Throws InputError when the scene has
  /// no volume or it exceeds the device's limit.
  explicit Medium(const Scene&, const char* technique);

  /// The defines of the forward pass, adapted to what this volume needs of medium.glsl: TRANSFER with a transfer
  /// function, LIGHT_SPACE for a volume in a light's space.
  gl::Defines defines(gl::Defines light_defines) const;
  /// Binds the maps (units 0, 3 and 4) and sets the uniforms of medium.glsl. `incident`:
  /// ForwardPass::uniform_incident().
  void bind(const gl::Program&, const Volume&, const glm::vec3& incident) const;

 private:
  gl::Texture density_, transfer_, scattering_;
  float density_unit_ = 1;  // what 1 in the map stands for
  glm::vec2 transfer_range_{0.0F};
};

/// Pieces of the volume's box as vertex buffer.
class BoxGeometry {
 public:
  void upload(BoxPieces);
  int pieces() const { return static_cast<int>(pieces_.size()); }
  void draw(int piece) const;

 private:
  gl::Buffer vertices_;
  gl::VertexArray array_;
  std::vector<BoxPieces::Piece> pieces_;
};

/// The volume of the scene, or InputError naming the technique that needs one.
const Volume& require_volume(const Scene&, const char* technique);

}  // namespace pellucid
