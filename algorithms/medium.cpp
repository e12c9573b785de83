#include "algorithms/medium.hpp"

#include <fmt/format.h>

#include "gl/context.hpp"

namespace pellucid {

const Volume& require_volume(const Scene& scene, const char* technique) {
  if (!scene.volume) throw InputError(fmt::format("{}: the scene '{}' has no volume", technique, scene.name));
  return *scene.volume;
}

Medium::Medium(const Scene& scene, const char* technique) {
  const Volume& volume = require_volume(scene, technique);
  const int limit = gl::limits().max_3d_texture_size;
  if (volume.size.x > limit || volume.size.y > limit || volume.size.z > limit) {
    throw InputError(fmt::format("{}: the volume '{}' has {}×{}×{} voxels, this device allows {} along an axis",
                                 technique, volume.name, volume.size.x, volume.size.y, volume.size.z, limit));
  }
  density_ =
      gl::Texture::make_3d(volume.name + " density", gl::Format::r16f, volume.size.x, volume.size.y, volume.size.z);
  density_.upload(volume.density);
  density_.set_sampling(gl::Filter::linear, gl::Wrap::clamp);
}

void Medium::bind(const gl::Program& program, const Volume& volume) const {
  density_.bind(0);
  program.set("volume_to_world", volume.to_world);
  program.set("volume_extinction", volume.extinction);
  program.set("volume_albedo", volume.albedo);
  program.set("volume_emission", volume.emission);
}

void BoxGeometry::upload(BoxPieces box) {
  const std::size_t bytes = box.vertices.size() * sizeof(glm::vec3);
  if (vertices_.bytes() < bytes) {
    vertices_ = gl::Buffer("box pieces", bytes, GL_DYNAMIC_DRAW);
    array_ = gl::VertexArray("box pieces", vertices_, sizeof(glm::vec3), {{0, 3, 0}});
  }
  if (bytes > 0) vertices_.upload(std::span<const glm::vec3>(box.vertices));
  pieces_ = std::move(box.pieces);
}

void BoxGeometry::draw(int piece) const {
  const BoxPieces::Piece& range = pieces_[static_cast<std::size_t>(piece)];
  if (range.count == 0) return;
  array_.bind();
  glDrawArrays(GL_TRIANGLES, range.first, range.count);
}

}  // namespace pellucid
