// Sampling hulls' frame against a bare shader's.
#include "algorithms/sampling_hulls/bench/bare_hulls.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/media/box_slicing.hpp"
#include "algorithms/media/medium.hpp"
#include "algorithms/raster/forward_pass.hpp"
#include "algorithms/sampling_hulls/sampling_hulls.hpp"
#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace pellucid::sampling_hulls {
namespace {

// sampling_hulls.cpp chooses the same way.
gl::Format map_format(const Scene& scene, Coordinates choice) {
  const glm::ivec3 size = scene.volume->size;
  const bool small = std::max({size.x, size.y, size.z}) < 256;
  return choice == Coordinates::unorm8 || (choice == Coordinates::automatic && small) ? gl::Format::rgba8
                                                                                      : gl::Format::rgba32f;
}

/// Lights whose shadow maps are read at each sampling point.
int shadow_lookups(const Scene& scene) {
  const int own = scene.volume->light;
  if (own >= 0) return scene.lights[static_cast<std::size_t>(own)].casts_shadow ? 1 : 0;
  return static_cast<int>(
      std::count_if(scene.lights.begin(), scene.lights.end(), [](const Light& light) { return light.casts_shadow; }));
}

/// The same opaque objects, and over the same hulls the same fetches and blends. The method is the session's own frame.
class BareHulls final : public BareFrame {
 public:
  explicit BareHulls(const BareFrameRequest& request)
      : scene_(request.scene),
        camera_(request.camera),
        parameters_(parameters_of<Parameters>(request, "sampling_hulls")),
        shadow_(request.shadow),
        session_frame_(request.session_frame),
        forward_(scene_),
        medium_(scene_, "bench"),
        target_(camera_, request.format) {
    map_ =
        gl::Texture::make_2d("bench map", map_format(scene_, parameters_.coordinates), camera_.width, camera_.height);
    map_.set_sampling(gl::Filter::nearest, gl::Wrap::clamp);
    map_framebuffer_ = gl::Framebuffer("bench map", {&map_}, &target_.depth);
    cut();
    compile();
  }

  void render(gl::PassTimer& timer, Part part) override {
    if (part == Part::method) return session_frame_(timer);
    timer.begin_frame();
    if (forward_.shadowed()) forward_.update_shadows(scene_, shadow_);
    map_framebuffer_.bind();
    coordinates_.set("world_to_local", glm::inverse(scene_.volume->to_world));
    forward_.draw_geometry(camera_, coordinates_);
    target_.framebuffer.bind();
    forward_.draw_shaded(camera_, true);
    if (part == Part::bare) draw_hulls();
    timer.end_frame();
    gl::check("bench", "bare hulls");
  }

  Counts counts() override {
    return {count_blends() / (static_cast<double>(camera_.width) * camera_.height),
            static_cast<double>(fetches_per_blend_)};
  }

 private:
  /// Fragments of front faces that pass the depth test, of one frame.
  double count_blends() {
    GLuint query = 0;
    glCreateQueries(GL_SAMPLES_PASSED, 1, &query);
    gl::PassTimer untimed;
    render(untimed, Part::shared);
    double fragments = 0;
    begin_hulls();
    for (int hull = 0; hull < geometry_.pieces(); ++hull) {
      draw_back(hull);
      glBeginQuery(GL_SAMPLES_PASSED, query);
      draw_front(hull);
      glEndQuery(GL_SAMPLES_PASSED);
      GLuint64 passed = 0;
      glGetQueryObjectui64v(query, GL_QUERY_RESULT, &passed);
      fragments += static_cast<double>(passed);
    }
    end_hulls();
    glDeleteQueries(1, &query);
    gl::check("count blends", "bare hulls");
    return fragments;
  }

  void cut() {
    geometry_.fit(*scene_.volume, camera_, BoxCut::hulls, parameters_.hulls);
    const glm::mat4 world_to_view = camera_.world_to_view();
    const auto range = depth_range(BoxDepth(scene_.volume->to_world, world_to_view), camera_.view.near_m);
    if (!range) return;
    const glm::vec3 axis = -glm::vec3(world_to_view[0][2], world_to_view[1][2], world_to_view[2][2]);
    const auto step_m = static_cast<float>((range->back - range->front) / (parameters_.hulls * parameters_.samples));
    step_local_ = glm::mat3(glm::inverse(scene_.volume->to_world)) * (axis * step_m);
  }

  void compile() {
    const std::string box = "algorithms/shaders/box.vert.glsl";
    coordinates_ = gl::Program("bench coordinates", {"algorithms/shaders/opaque.vert.glsl",
                                                     "algorithms/sampling_hulls/coordinates.frag.glsl"});
    back_ = gl::Program("bench back", {box, "algorithms/sampling_hulls/bench/bare_back.frag.glsl"});
    gl::Defines defines = medium_.defines(forward_.light_defines());
    auto defined = [&](std::string_view wanted) {
      return std::any_of(defines.begin(), defines.end(), [&](const auto& define) { return define.first == wanted; });
    };
    int shadow_fetches = 0;
    if (defined("SHADOWS")) {
      shadow_fetches =
          shadow_lookups(scene_) * (parameters_.filter_occlusion ? 2 * parameters_.samples + 1 : parameters_.samples);
    }
    const int maps = 1 + (defined("TRANSFER") ? 1 : 0) + (defined("LIGHT_SPACE") ? 1 : 0);
    fetches_per_blend_ = 1 + maps * parameters_.samples + shadow_fetches;
    defines.emplace_back("SAMPLES", fmt::to_string(parameters_.samples));
    defines.emplace_back("SHADOW_FETCHES", fmt::to_string(shadow_fetches));
    front_ = gl::Program("bench front", {box, "algorithms/sampling_hulls/bench/bare_front.frag.glsl"}, defines);
  }

  // The state and the draws of sampling_hulls.cpp.
  void begin_hulls() {
    glEnable(GL_DEPTH_CLAMP);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    glDepthMask(GL_FALSE);
    glEnable(GL_CULL_FACE);
    glBlendFuncSeparate(GL_ONE, GL_SRC_ALPHA, GL_ZERO, GL_SRC_ALPHA);
    back_.set("local_to_clip", camera_.projection() * camera_.world_to_view() * scene_.volume->to_world);
    front_.set("step_local", step_local_);
    medium_.bind(front_, *scene_.volume, camera_, glm::vec3(0.0F));  // it only sums
    map_.bind(1);
    forward_.bind_lights();
  }
  void draw_back(int hull) const {
    glCullFace(GL_FRONT);
    glDisable(GL_BLEND);
    map_framebuffer_.bind();
    back_.use();
    geometry_.draw(hull);
  }
  void draw_front(int hull) const {
    glCullFace(GL_BACK);
    glEnable(GL_BLEND);
    target_.framebuffer.bind();
    front_.use();
    geometry_.draw(hull);
  }
  static void end_hulls() {
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glDisable(GL_DEPTH_CLAMP);
    glDepthMask(GL_TRUE);
  }
  void draw_hulls() {
    begin_hulls();
    for (int hull = 0; hull < geometry_.pieces(); ++hull) {
      draw_back(hull);
      draw_front(hull);
    }
    end_hulls();
  }

  const Scene& scene_;
  Camera camera_;
  Parameters parameters_;
  ShadowSettings shadow_;
  std::function<void(gl::PassTimer&)> session_frame_;
  ForwardPass forward_;
  Medium medium_;
  BoxGeometry geometry_;
  glm::vec3 step_local_{0.0F};
  BareFrameTarget target_;
  gl::Texture map_;
  gl::Framebuffer map_framebuffer_;
  gl::Program coordinates_, back_, front_;
  int fetches_per_blend_ = 0;
};

}  // namespace

const BareFrameInfo& bare_frame() {
  static constexpr BareFrameInfo kInfo{.technique = "sampling_hulls",
                                       .scene = "fog_forest",
                                       .make = [](const BareFrameRequest& request) -> std::unique_ptr<BareFrame> {
                                         return std::make_unique<BareHulls>(request);
                                       },
                                       .counts =
                                           [](const nlohmann::json& p) {
                                             return fmt::format("{} hulls of {} samples", p.at("hulls").get<int>(),
                                                                p.at("samples").get<int>());
                                           },
                                       .volume = true};
  return kInfo;
}

}  // namespace pellucid::sampling_hulls
