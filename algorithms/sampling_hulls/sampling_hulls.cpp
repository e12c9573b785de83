// Sampling hulls: Imagire, Johan, Tamura, Nishita 2007 (references.bib: imagire2007).
#include "algorithms/sampling_hulls/sampling_hulls.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "algorithms/media/box_slicing.hpp"
#include "algorithms/media/medium.hpp"
#include "algorithms/raster/forward_pass.hpp"
#include "gl/program.hpp"

namespace pellucid::sampling_hulls {
namespace {

constexpr const char* kName = "sampling_hulls";
// Up to here the points of a path are written out one by one; compiling takes longer with each.
constexpr int kMostUnrolledSamples = 8;

class SamplingHulls final : public Technique {
 public:
  ParameterRef parameters() override { return bind_parameters(parameters_); }

  void prepare(const Scene& scene) override {
    medium_.emplace(scene, kName);
    // Sec. 4: 8 bits suffice for the local-coordinates map of a volume of fewer than 256 voxels along each axis.
    const glm::ivec3 size = scene.volume->size;
    const bool small = std::max({size.x, size.y, size.z}) < 256;
    const bool unorm8 =
        parameters_.coordinates == Coordinates::unorm8 || (parameters_.coordinates == Coordinates::automatic && small);
    map_format_ = unorm8 ? gl::Format::rgba8 : gl::Format::rgba32f;
    map_ = {};
  }

  void render(const Scene& scene, const Camera& camera, ForwardPass& forward, const Target& target,
              gl::PassTimer& timer) override {
    fit_map(target);
    compile(medium_->defines(forward.light_defines()));
    const Volume& volume = *scene.volume;
    geometry_.fit(volume, camera, BoxCut::hulls, parameters_.hulls);

    // Step 1: opaque objects into the local-coordinates map.
    {
      auto pass = timer.pass("coordinates");
      map_framebuffer_.bind();
      coordinates_.set("world_to_local", glm::inverse(volume.to_world));
      forward.draw_geometry(camera, coordinates_);
    }
    // Step 2: opaque objects into the back buffer, with the depth of step 1.
    {
      auto pass = timer.pass("opaque");
      target.framebuffer.bind();
      forward.draw_shaded(camera, true);
    }
    // Steps 3 to 2 + 2M: for each hull, back to front, its back faces into the map and its front faces into the back
    // buffer.
    auto pass = timer.pass("hulls");
    // All vertices lie at or behind the near plane; clamping keeps rounding from cutting holes into a cap that lies in
    // it, and the far plane from cutting the volume.
    glEnable(GL_DEPTH_CLAMP);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    glDepthMask(GL_FALSE);
    glEnable(GL_CULL_FACE);
    glBlendFuncSeparate(GL_ONE, GL_SRC_ALPHA, GL_ZERO, GL_SRC_ALPHA);  // A × BackBuffer + C
    back_.set("local_to_clip", camera.projection() * camera.world_to_view() * volume.to_world);
    front_.set("path_sample_offset", parameters_.sample_offset);
    medium_->bind(front_, volume, camera, forward.uniform_incident());
    map_.bind(1);
    forward.bind_lights();
    for (int hull = 0; hull < geometry_.pieces(); ++hull) {
      glCullFace(GL_FRONT);
      glDisable(GL_BLEND);
      map_framebuffer_.bind();
      back_.use();
      geometry_.draw(hull);

      glCullFace(GL_BACK);
      glEnable(GL_BLEND);
      target.framebuffer.bind();
      front_.use();
      geometry_.draw(hull);
    }
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glDisable(GL_DEPTH_CLAMP);
    glDepthMask(GL_TRUE);
  }

  std::string reload_shaders() override {
    std::string words;
    for (gl::Program* program : {&coordinates_, &back_, &front_}) {
      if (*program) words += program->reload();
    }
    return words;
  }

 private:
  void fit_map(const Target& target) {
    if (map_ && map_.width() == target.color.width() && map_.height() == target.color.height() &&
        shared_depth_ == target.depth.id()) {
      return;
    }
    map_ = gl::Texture::make_2d("local-coordinates map", map_format_, target.color.width(), target.color.height());
    map_.set_sampling(gl::Filter::nearest, gl::Wrap::clamp);
    map_framebuffer_ = gl::Framebuffer("local-coordinates map", {&map_}, &target.depth);
    shared_depth_ = target.depth.id();
  }

  void compile(gl::Defines defines) {
    if (!coordinates_) {
      coordinates_ = gl::Program("hull coordinates", {"algorithms/shaders/opaque.vert.glsl",
                                                      "algorithms/sampling_hulls/coordinates.frag.glsl"});
      back_ =
          gl::Program("hull back", {"algorithms/shaders/box.vert.glsl", "algorithms/sampling_hulls/back.frag.glsl"});
    }
    defines.emplace_back("SAMPLES", fmt::to_string(parameters_.samples));
    if (parameters_.samples <= kMostUnrolledSamples) {
      std::string each;
      for (int i = 0; i < parameters_.samples; ++i)
        each += fmt::format("SAMPLE({}) ", i);
      defines.emplace_back("EACH_SAMPLE", each);
    }
    if (parameters_.filter_occlusion) defines.emplace_back("FILTER_OCCLUSION", "1");
    if (front_ && defines == front_defines_) return;
    front_ = gl::Program("hull front",
                         {"algorithms/shaders/medium.vert.glsl", "algorithms/sampling_hulls/front.frag.glsl"}, defines);
    front_defines_ = std::move(defines);
  }

  Parameters parameters_;
  std::optional<Medium> medium_;
  gl::Format map_format_ = gl::Format::rgba8;
  gl::Texture map_;
  gl::Framebuffer map_framebuffer_;
  GLuint shared_depth_ = 0;
  gl::Program coordinates_, back_, front_;
  gl::Defines front_defines_;
  BoxGeometry geometry_;
};

}  // namespace

const ParameterTable& table() {
  return parameter_table<Parameters>();
}
std::unique_ptr<Technique> make() {
  return std::make_unique<SamplingHulls>();
}

}  // namespace pellucid::sampling_hulls
