// Slices, the baseline of Imagire et al. 2007 (references.bib: cullip1994, imagire2007), Sec. 2.1.
#include "algorithms/volume_slices/volume_slices.hpp"

#include <optional>
#include <string>
#include <utility>

#include "algorithms/media/box_slicing.hpp"
#include "algorithms/media/medium.hpp"
#include "algorithms/raster/forward_pass.hpp"
#include "gl/program.hpp"

namespace pellucid::volume_slices {
namespace {

constexpr const char* kName = "volume_slices";

class VolumeSlices final : public Technique {
 public:
  ParameterRef parameters() override { return bind_parameters(parameters_); }

  void prepare(const Scene& scene) override { medium_.emplace(scene, kName); }

  void render(const Scene& scene, const Camera& camera, ForwardPass& forward, const Target& target,
              gl::PassTimer& timer) override {
    const Volume& volume = *scene.volume;
    const bool image_aligned = parameters_.alignment == Alignment::image;
    compile(medium_->defines(forward.light_defines()), image_aligned);
    geometry_.fit(volume, camera, image_aligned ? BoxCut::image_slices : BoxCut::object_slices, parameters_.slices);
    {
      auto pass = timer.pass("opaque");
      target.framebuffer.bind();
      forward.draw_shaded(camera, false);
    }
    auto pass = timer.pass("slices");
    glEnable(GL_DEPTH_TEST);
    // The far plane cuts objects, not the medium. Image-aligned slices lie behind the near plane; object-aligned ones
    // are clipped by it.
    glEnable(GL_DEPTH_CLAMP);
    if (!image_aligned) glEnable(GL_CLIP_DISTANCE0);
    glDepthFunc(GL_LEQUAL);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_ONE, GL_SRC_ALPHA, GL_ZERO, GL_SRC_ALPHA);
    program_.set("slab_axis", geometry_.slab_axis());
    program_.set("slab_m", geometry_.slab_m());
    medium_->bind(program_, volume, camera, forward.uniform_incident());
    forward.bind_lights();
    program_.use();
    if (geometry_.pieces() > 0) geometry_.draw(0);
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_CLAMP);
    glDisable(GL_CLIP_DISTANCE0);
    glDepthMask(GL_TRUE);
  }

  std::string reload_shaders() override { return program_ ? program_.reload() : std::string(); }

 private:
  void compile(gl::Defines defines, bool image_aligned) {
    if (!image_aligned) defines.emplace_back("CLIP_AT_NEAR_PLANE", "1");
    if (program_ && defines == defines_) return;
    program_ = gl::Program("slice", {"algorithms/shaders/medium.vert.glsl", "algorithms/volume_slices/slice.frag.glsl"},
                           defines);
    defines_ = std::move(defines);
  }

  Parameters parameters_;
  std::optional<Medium> medium_;
  gl::Program program_;
  gl::Defines defines_;
  BoxGeometry geometry_;
};

}  // namespace

const ParameterTable& table() {
  return parameter_table<Parameters>();
}
std::unique_ptr<Technique> make() {
  return std::make_unique<VolumeSlices>();
}

}  // namespace pellucid::volume_slices
