// Slices, the baseline of Imagire et al. 2007 (references.bib: cullip1994, imagire2007), Sec. 2.1.
#include "algorithms/volume_slices/volume_slices.hpp"

#include <optional>

#include "algorithms/box_slicing.hpp"
#include "algorithms/forward_pass.hpp"
#include "algorithms/medium.hpp"
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
    compile(medium_->defines(forward.light_defines()));
    const Volume& volume = *scene.volume;
    cut(volume, camera);
    {
      auto pass = timer.pass("opaque");
      target.framebuffer.bind();
      forward.draw_shaded(camera, false);
    }
    auto pass = timer.pass("slices");
    const glm::mat4 world_to_view = camera.world_to_view();
    glEnable(GL_DEPTH_TEST);
    // Image-aligned slices lie behind the near plane; object-aligned ones are clipped by it.
    if (parameters_.alignment == Alignment::image) glEnable(GL_DEPTH_CLAMP);
    glDepthFunc(GL_LEQUAL);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_ONE, GL_SRC_ALPHA, GL_ZERO, GL_SRC_ALPHA);
    program_.set("local_to_clip", camera.projection() * world_to_view * volume.to_world);
    program_.set("eye", camera.view.eye);
    program_.set("slab_axis", slab_axis_);
    program_.set("slab_m", slab_m_);
    medium_->bind(program_, volume, forward.uniform_incident());
    forward.bind_lights();
    program_.use();
    if (geometry_.pieces() > 0) geometry_.draw(0);
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_CLAMP);
    glDepthMask(GL_TRUE);
  }

  std::string reload_shaders() override { return program_ ? program_.reload() : std::string(); }

 private:
  void compile(const gl::Defines& defines) {
    if (program_ && defines == defines_) return;
    program_ = gl::Program(
        "slice", {"algorithms/shaders/common/box.vert.glsl", "algorithms/volume_slices/slice.frag.glsl"}, defines);
    defines_ = defines;
  }

  void cut(const Volume& volume, const Camera& camera) {
    const CutKey key{camera.world_to_view(), volume.to_world, camera.view.near_m, parameters_.slices,
                     parameters_.alignment};
    if (cut_ == key) return;
    const BoxDepth depth(volume.to_world, key.world_to_view);
    const auto range = depth_range(depth, key.near_m);
    if (!range) {
      geometry_.upload({});
    } else if (key.alignment == Alignment::image) {
      geometry_.upload(cut_slices(depth, *range, key.slices));
      slab_m_ = static_cast<float>((range->back - range->front) / key.slices);
      slab_axis_ = -glm::vec3(key.world_to_view[0].z, key.world_to_view[1].z, key.world_to_view[2].z);
    } else {
      const ObjectSlices slices = cut_object_slices(volume.to_world, key.world_to_view, camera.view.eye, key.slices);
      geometry_.upload(slices.polygons);
      slab_m_ = slices.slab_m;
      slab_axis_ = slices.axis;
    }
    cut_ = key;
  }

  struct CutKey {
    glm::mat4 world_to_view, to_world;
    float near_m;
    int slices;
    Alignment alignment;
    bool operator==(const CutKey&) const = default;
  };

  Parameters parameters_;
  std::optional<Medium> medium_;
  gl::Program program_;
  gl::Defines defines_;
  BoxGeometry geometry_;
  float slab_m_ = 0;
  glm::vec3 slab_axis_{0.0F};
  std::optional<CutKey> cut_;
};

}  // namespace

const ParameterTable& table() {
  return parameter_table<Parameters>();
}
std::unique_ptr<Technique> make() {
  return std::make_unique<VolumeSlices>();
}

}  // namespace pellucid::volume_slices
