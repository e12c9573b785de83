#pragma once

#include <optional>
#include <vector>

#include "algorithms/media/box_slicing.hpp"
#include "algorithms/scene/scene.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace pellucid {

/// A volume on the GPU, for programs of shaders/medium.vert.glsl and a fragment shader that includes
/// medium.glsl.
class Medium {
 public:
  /// Uploads density and scattering as R16F and the transfer function as a table. Throws InputError when the scene has
  /// no volume or it exceeds the device's limit.
  explicit Medium(const Scene&, const char* technique);

  /// The defines of the forward pass, adapted to what this volume needs of medium.glsl: TRANSFER with a transfer
  /// function, LIGHT_SPACE with the light's index for a volume in a light's space.
  gl::Defines defines(gl::Defines light_defines) const;
  /// Binds the maps (units 0, 3 and 4) and sets the uniforms of medium.vert.glsl but those of the points on a path.
  /// `incident`: ForwardPass::uniform_incident().
  void bind(const gl::Program&, const Volume&, const Camera&, const glm::vec3& incident) const;

 private:
  gl::Texture density_, transfer_, scattering_;
  float density_unit_ = 1;  // what 1 in the map stands for
  glm::vec2 transfer_scale_offset_{0.0F};
  int light_ = -1;
};

/// Ways to cut a volume's box (box_slicing.hpp).
enum class BoxCut { hulls, image_slices, object_slices };

/// Pieces of a volume's box as vertex buffer; cut and uploaded only when they change.
class BoxGeometry {
 public:
  /// Hulls become that many pieces, slices one, and a box behind the near plane none. Returns true if it was cut anew.
  bool fit(const Volume&, const Camera&, BoxCut, int count);
  int pieces() const { return static_cast<int>(pieces_.size()); }
  void draw(int piece) const;

  /// The thickness that each slice stands for, along an axis across them (unit, world).
  float slab_m() const { return slab_m_; }
  const glm::vec3& slab_axis() const { return slab_axis_; }

 private:
  struct Key {
    glm::mat4 world_to_view, to_world;
    float near_m;
    BoxCut cut;
    int count;
    bool operator==(const Key&) const = default;
  };
  BoxPieces cut(const Key&, const glm::vec3& eye);
  void upload(BoxPieces);

  std::optional<Key> key_;
  gl::Buffer vertices_;
  gl::VertexArray array_;
  std::vector<BoxPieces::Piece> pieces_;
  float slab_m_ = 0;
  glm::vec3 slab_axis_{0.0F};
};

/// The volume of the scene, or InputError naming the technique that needs one.
const Volume& require_volume(const Scene&, const char* technique);

}  // namespace pellucid
