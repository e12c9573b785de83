#include "algorithms/local_cube_maps/impostor_cube.hpp"

#include <algorithm>

namespace pellucid::local_cube_maps {
namespace {

constexpr float kSkyReaches = 16;          // as many times farther than the farthest corner of the scene
constexpr float kFarthestHalf = 60000.0F;  // what 16 bits hold

}  // namespace

ImpostorCube::ImpostorCube(const std::string& label, const MapSettings& settings) {
  const bool half = settings.format == CubeFormat::half;
  radiance_ =
      gl::Texture::make_cube(label + " radiance", half ? gl::Format::rgba16f : gl::Format::rgba32f, settings.cube_size);
  depth_ = gl::Texture::make_cube(label + " depth", gl::Format::depth32f, settings.cube_size);
  radiance_.set_sampling(gl::Filter::linear, gl::Wrap::clamp);
  if (settings.store == DistanceStore::alpha) {
    target_ = CubeTarget(label, {&radiance_}, &depth_);
    return;
  }
  distance_ =
      gl::Texture::make_cube(label + " distance", half ? gl::Format::r16f : gl::Format::r32f, settings.cube_size);
  distance_.set_sampling(gl::Filter::linear, gl::Wrap::clamp);
  // So that shaders read alpha, whichever texture it is.
  glTextureParameteri(distance_.id(), GL_TEXTURE_SWIZZLE_A, GL_RED);
  target_ = CubeTarget(label, {&radiance_, &distance_}, &depth_);
}

void ImpostorCube::draw(CubeScene& scene, const ForwardPass& forward, const CubeCamera& camera) {
  camera_ = camera;
  scene.draw(forward, camera, target_, distance_ ? CubeScene::Distance::own : CubeScene::Distance::alpha,
             std::min(kSkyReaches * camera.far_m, kFarthestHalf));
}

void ImpostorCube::bind() const {
  radiance_.bind(4);
  distance().bind(5);
}

}  // namespace pellucid::local_cube_maps
