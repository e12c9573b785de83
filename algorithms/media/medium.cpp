#include "algorithms/media/medium.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "gl/context.hpp"

namespace pellucid {

const Volume& require_volume(const Scene& scene, const char* technique) {
  if (!scene.volume) throw InputError(fmt::format("{}: the scene '{}' has no volume", technique, scene.name));
  return *scene.volume;
}

namespace {

// Fine enough that a kink of the piecewise linear function is cut by less than 1/2048 of its range.
constexpr int kTransferTexels = 1024;

std::vector<float> tabulate(const std::vector<TransferPoint>& transfer) {
  const float low = transfer.front().density, high = transfer.back().density;
  std::vector<float> texels;
  std::size_t k = 0;
  for (int i = 0; i < kTransferTexels; ++i) {
    const float density = low + (high - low) * static_cast<float>(i) / (kTransferTexels - 1);
    while (k + 2 < transfer.size() && transfer[k + 1].density < density)
      ++k;
    const TransferPoint &a = transfer[k], &b = transfer[k + 1];
    const float t = glm::clamp((density - a.density) / (b.density - a.density), 0.0F, 1.0F);
    const glm::vec3 albedo = glm::mix(a.albedo, b.albedo, t);
    texels.insert(texels.end(), {albedo.x, albedo.y, albedo.z, glm::mix(a.extinction, b.extinction, t)});
  }
  return texels;
}

gl::Texture make_map(const std::string& label, const glm::ivec3& size, const std::vector<float>& voxels) {
  gl::Texture map = gl::Texture::make_3d(label, gl::Format::r16f, size.x, size.y, size.z);
  map.upload(voxels);
  map.set_sampling(gl::Filter::linear, gl::Wrap::clamp);
  return map;
}

// Densities beyond what 16-bit floats hold, or so small that those lose their bits, are stored as multiples of a power
// of two, which changes none of them.
float map_unit(const std::vector<float>& density) {
  const float greatest = *std::max_element(density.begin(), density.end());
  if (greatest == 0 || (greatest >= 1.0F / 64 && greatest < 32768)) return 1;
  int exponent = 0;
  std::frexp(greatest, &exponent);
  return std::ldexp(1.0F, std::max(exponent, -60));
}

std::vector<float> in_unit(std::vector<float> density, float unit) {
  for (float& d : density)
    d /= unit;
  return density;
}

}  // namespace

Medium::Medium(const Scene& scene, const char* technique) {
  const Volume& volume = require_volume(scene, technique);
  const int limit = gl::limits().max_3d_texture_size;
  if (volume.size.x > limit || volume.size.y > limit || volume.size.z > limit) {
    throw InputError(fmt::format("{}: the volume '{}' has {}×{}×{} voxels, this device allows {} along an axis",
                                 technique, volume.name, volume.size.x, volume.size.y, volume.size.z, limit));
  }
  density_unit_ = map_unit(volume.density);
  const std::string label = volume.name + " density";
  density_ = density_unit_ == 1 ? make_map(label, volume.size, volume.density)
                                : make_map(label, volume.size, in_unit(volume.density, density_unit_));
  light_ = volume.light;
  if (light_ >= 0) scattering_ = make_map(volume.name + " scattering", volume.size, volume.scattering);
  if (!volume.transfer.empty()) {
    transfer_ = gl::Texture::make_2d(volume.name + " transfer", gl::Format::rgba32f, kTransferTexels, 1);
    transfer_.upload(tabulate(volume.transfer));
    transfer_.set_sampling(gl::Filter::linear, gl::Wrap::clamp);
    const float low = volume.transfer.front().density;
    // The least density lies at the centre of the first texel, the greatest at that of the last.
    const float texels = (kTransferTexels - 1) / (volume.transfer.back().density - low);
    transfer_scale_offset_ =
        glm::vec2(texels * density_unit_, 0.5F - low * texels) / static_cast<float>(kTransferTexels);
  }
}

gl::Defines Medium::defines(gl::Defines light_defines) const {
  if (!transfer_ && !scattering_) return light_defines;
  // The source then depends on the place, whatever the lights do.
  std::erase_if(light_defines, [](const auto& define) { return define.first == "UNIFORM_SOURCE"; });
  if (transfer_) light_defines.emplace_back("TRANSFER", "1");
  if (scattering_) light_defines.emplace_back("LIGHT_SPACE", std::to_string(light_));
  return light_defines;
}

void Medium::bind(const gl::Program& program, const Volume& volume, const Camera& camera,
                  const glm::vec3& incident) const {
  density_.bind(0);
  program.set("local_to_clip", camera.projection() * camera.world_to_view() * volume.to_world);
  program.set("world_to_local", glm::inverse(volume.to_world));
  program.set("eye", camera.view.eye);
  program.set("volume_to_world", volume.to_world);
  program.set("volume_extinction", transfer_ ? volume.extinction : volume.extinction * density_unit_);
  program.set("volume_albedo", volume.albedo);
  program.set("volume_emission", volume.emission);
  program.set("uniform_source", volume.emission + volume.albedo * incident);
  if (transfer_) {
    transfer_.bind(3);
    program.set("transfer_scale_offset", transfer_scale_offset_);
  }
  if (scattering_) scattering_.bind(4);
}

bool BoxGeometry::fit(const Volume& volume, const Camera& camera, BoxCut way, int count) {
  const Key key{camera.world_to_view(), volume.to_world, camera.view.near_m, way, count};
  if (key_ == key) return false;
  upload(cut(key, camera.view.eye));
  key_ = key;
  return true;
}

BoxPieces BoxGeometry::cut(const Key& key, const glm::vec3& eye) {
  const BoxDepth depth(key.to_world, key.world_to_view);
  const auto range = depth_range(depth, static_cast<double>(key.near_m));
  if (!range) return {};
  if (key.cut == BoxCut::hulls) return cut_hulls(depth, *range, key.count);
  if (key.cut == BoxCut::image_slices) {
    slab_m_ = static_cast<float>((range->back - range->front) / key.count);
    slab_axis_ = -glm::vec3(key.world_to_view[0].z, key.world_to_view[1].z, key.world_to_view[2].z);
    return cut_slices(depth, *range, key.count);
  }
  ObjectSlices slices = cut_object_slices(key.to_world, key.world_to_view, eye, key.count);
  slab_m_ = slices.slab_m;
  slab_axis_ = slices.axis;
  return std::move(slices.polygons);
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
