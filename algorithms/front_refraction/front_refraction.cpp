// Chan and Wang 2005 (references.bib: chan2005), Fig. 1a: refraction at the front side alone.
#include "algorithms/front_refraction/front_refraction.hpp"

#include <cstddef>
#include <string>
#include <utility>

#include "algorithms/raster/environment_alone.hpp"
#include "algorithms/raster/forward_pass.hpp"
#include "algorithms/raster/mirror.hpp"
#include "gl/program.hpp"

namespace pellucid::front_refraction {
namespace {

class FrontRefraction final : public Technique {
 public:
  ParameterRef parameters() override { return bind_parameters(parameters_); }
  void prepare(const Scene& scene) override { warn_of_black_environment(scene, "front_refraction"); }

  void render(const Scene& scene, const Camera& camera, ForwardPass& forward, const Target& target,
              gl::PassTimer& timer) override {
    gl::Defines defines = forward.environment_defines();
    if (!program_ || defines != defines_) {
      program_ =
          gl::Program("front refraction",
                      {"algorithms/shaders/opaque.vert.glsl", "algorithms/front_refraction/front.frag.glsl"}, defines);
      defines_ = std::move(defines);
    }
    {
      auto pass = timer.pass("opaque");
      target.framebuffer.bind();
      forward.draw_shaded(camera, false);
    }
    auto pass = timer.pass("glass");
    forward.bind_environment(program_);
    program_.set("eye", camera.view.eye);
    program_.set("reflection", parameters_.reflection);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    glDepthMask(GL_TRUE);
    glEnable(GL_CULL_FACE);
    glCullFace(GL_BACK);
    const glm::mat4 world_to_clip = camera.projection() * camera.world_to_view();
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
      const Instance& instance = scene.instances[i];
      if (!optical(scene, instance)) continue;
      const Material& material = material_of(scene, instance);
      program_.set("dielectric", material.kind == SurfaceKind::dielectric);
      program_.set("ior", material.ior);
      set_mirror(program_, material);
      glFrontFace(glm::determinant(glm::mat3(instance.to_world)) < 0 ? GL_CW : GL_CCW);
      forward.draw_instance(scene, static_cast<int>(i), world_to_clip, program_);
    }
    glFrontFace(GL_CCW);
    glDisable(GL_CULL_FACE);
  }

  std::string reload_shaders() override { return program_ ? program_.reload() : std::string(); }

 private:
  Parameters parameters_;
  gl::Program program_;
  gl::Defines defines_;
};

}  // namespace

const ParameterTable& table() {
  return parameter_table<Parameters>();
}
std::unique_ptr<Technique> make() {
  return std::make_unique<FrontRefraction>();
}

}  // namespace pellucid::front_refraction
