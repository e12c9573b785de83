#pragma once

#include <cstdint>
#include <string>

#include "algorithms/scene/scene.hpp"
#include "algorithms/translucent_relief/animation.hpp"
#include "algorithms/translucent_relief/transfer.hpp"
#include "algorithms/translucent_relief/translucent_relief.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace pellucid::translucent_relief {

/// A relief's images as textures.
class ReliefMaps {
 public:
  /// Uploads what changed since the last call, with what the search precomputes; moving layers are made by `animation`,
  /// unless it is null.
  void update(const Relief&, Search, Animation* animation);
  /// Binds the textures and sets the uniforms of layers.glsl.
  void bind(const Relief&, const gl::Program&) const;
  float mean_solid_height_m(const Relief&) const;

 private:
  struct Layer {
    gl::Texture heights, normals, acceleration;
  };
  static void upload(const ReliefLayer&, Search, Animation*, Layer&);

  Layer solid_, medium_;
  gl::Texture colors_, air_;
  Transfer transfer_;
  float mean_solid_ = 0;  // of the heights in [0, 1]
  std::uint64_t revision_ = 0;
};

/// A mesh with its texture's tangents, for relief.vert.glsl.
class ReliefMesh {
 public:
  /// InputError: no texture coordinates, no tangents.
  ReliefMesh(const Mesh&, const std::string& what);
  void draw() const;

 private:
  gl::Buffer vertices_, indices_;
  gl::VertexArray array_;
  int index_count_ = 0;
};

}  // namespace pellucid::translucent_relief
