// One-pass volume ray casting (references.bib: kruger2003) with interleaved sampling (keller2001).
#include "algorithms/ray_marching/ray_marching.hpp"

#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "algorithms/media/box_slicing.hpp"
#include "algorithms/media/medium.hpp"
#include "algorithms/raster/forward_pass.hpp"
#include "gl/program.hpp"

namespace pellucid::ray_marching {
namespace {

constexpr const char* kName = "ray_marching";

// The smallest step near the golden section of the tile's pixels that meets each of them once.
int golden_stride(int count) {
  int stride = static_cast<int>(0.618 * count);
  while (std::gcd(stride, count) != 1)
    ++stride;
  return stride;
}

class RayMarching final : public Technique {
 public:
  ParameterRef parameters() override { return bind_parameters(parameters_); }

  void prepare(const Scene& scene) override {
    medium_.emplace(scene, kName);
    distance_ = {};  // the target may be another of the same name
  }

  void render(const Scene& scene, const Camera& camera, ForwardPass& forward, const Target& target,
              gl::PassTimer& timer) override {
    fit(target);
    compile(medium_->defines(forward.light_defines()));
    const Volume& volume = *scene.volume;
    const glm::mat4 world_to_view = camera.world_to_view();
    geometry_.fit(volume, camera, BoxCut::hulls, 1);
    {
      auto pass = timer.pass("opaque");
      with_distance_.bind();
      forward.draw_shaded(camera, false);
    }
    if (geometry_.pieces() == 0) return;
    auto pass = timer.pass("march");
    color_only_.bind();
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_DEPTH_CLAMP);
    glEnable(GL_CULL_FACE);
    glCullFace(GL_FRONT);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_ONE, GL_SRC_ALPHA, GL_ZERO, GL_SRC_ALPHA);
    program_.set("view_axis", -glm::vec3(world_to_view[0].z, world_to_view[1].z, world_to_view[2].z));
    program_.set("near_m", camera.view.near_m);
    program_.set("path_sample_count", parameters_.samples);
    program_.set("path_sample_offset", parameters_.sample_offset);
    medium_->bind(program_, volume, camera, forward.uniform_incident());
    forward.bind_lights();
    distance_.bind(1);
    program_.use();
    geometry_.draw(0);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glDisable(GL_DEPTH_CLAMP);
    glEnable(GL_DEPTH_TEST);
  }

  std::string reload_shaders() override { return program_ ? program_.reload() : std::string(); }

 private:
  void fit(const Target& target) {
    if (target_ == target.color.id() && distance_) return;
    distance_ = gl::Texture::make_2d("eye distance", gl::Format::r32f, target.color.width(), target.color.height());
    with_distance_ = gl::Framebuffer("frame and distance", {&target.color, &distance_}, &target.depth);
    color_only_ = gl::Framebuffer("frame colour", {&target.color});
    target_ = target.color.id();
  }

  void compile(gl::Defines defines) {
    if (parameters_.filter_occlusion) defines.emplace_back("FILTER_OCCLUSION", "1");
    if (parameters_.jitter == Jitter::interleaved) {
      defines.emplace_back("JITTER_TILE", fmt::to_string(parameters_.tile));
      defines.emplace_back("JITTER_STRIDE", fmt::to_string(golden_stride(parameters_.tile * parameters_.tile)));
    }
    if (program_ && defines == defines_) return;
    program_ = gl::Program("march", {"algorithms/shaders/medium.vert.glsl", "algorithms/ray_marching/march.frag.glsl"},
                           defines);
    defines_ = std::move(defines);
  }

  Parameters parameters_;
  std::optional<Medium> medium_;
  gl::Texture distance_;
  gl::Framebuffer with_distance_, color_only_;
  GLuint target_ = 0;
  gl::Program program_;
  gl::Defines defines_;
  BoxGeometry geometry_;
};

}  // namespace

const ParameterTable& table() {
  return parameter_table<Parameters>();
}
std::unique_ptr<Technique> make() {
  return std::make_unique<RayMarching>();
}

}  // namespace pellucid::ray_marching
