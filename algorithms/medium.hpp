#pragma once

#include "algorithms/box_slicing.hpp"
#include "algorithms/scene/scene.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace pellucid {

/// A volume on the GPU, for programs that include shaders/common/medium.glsl.
class Medium {
 public:
  /// Uploads the density as R16F. Throws InputError when the scene has no volume or it exceeds the device's limit.
  explicit Medium(const Scene&, const char* technique);

  /// Binds the density map (unit 0) and sets the uniforms of medium.glsl.
  void bind(const gl::Program&, const Volume&) const;

 private:
  gl::Texture density_;
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
