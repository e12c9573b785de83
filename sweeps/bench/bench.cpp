#include "sweeps/bench/bench.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/media/box_slicing.hpp"
#include "algorithms/media/medium.hpp"
#include "algorithms/raster/forward_pass.hpp"
#include "algorithms/render_session.hpp"
#include "gl/context.hpp"
#include "gl/error.hpp"
#include "sweeps/bench/bench_subjects.hpp"
#include "sweeps/measure/frame_clock.hpp"

namespace pellucid::sweeps {
namespace {

constexpr const char* kTechnique = "sampling_hulls";
constexpr std::size_t kWarmUpFrames = 64;
constexpr double kWarmUpSeconds = 10;

/// What of the technique's parameters decides on fetches and blends.
struct HullCounts {
  int hulls = 0;
  int samples = 0;
  bool filter_occlusion = false;
};

/// Lights whose shadow maps are read at each sampling point.
int shadow_lookups(const Scene& scene) {
  const int own = scene.volume->light;
  if (own >= 0) return scene.lights[static_cast<std::size_t>(own)].casts_shadow ? 1 : 0;
  return static_cast<int>(
      std::count_if(scene.lights.begin(), scene.lights.end(), [](const Light& light) { return light.casts_shadow; }));
}

/// The bare shader's frame: the same opaque objects, and over the same hulls the same fetches and blends.
class BareHulls {
 public:
  BareHulls(const Scene& scene, const Camera& camera, const ShadowSettings& shadow, const HullCounts& counts,
            gl::Format color_format, gl::Format map_format)
      : scene_(scene),
        camera_(camera),
        shadow_(shadow),
        forward_(scene),
        medium_(scene, "bench"),
        target_(camera, color_format) {
    map_ = gl::Texture::make_2d("bench map", map_format, camera.width, camera.height);
    map_.set_sampling(gl::Filter::nearest, gl::Wrap::clamp);
    map_framebuffer_ = gl::Framebuffer("bench map", {&map_}, &target_.depth);
    cut(counts);
    compile(counts);
  }

  int fetches_per_blend() const { return fetches_per_blend_; }

  void render(gl::PassTimer& timer, bool with_hulls) {
    timer.begin_frame();
    if (forward_.shadowed()) forward_.update_shadows(scene_, shadow_);
    map_framebuffer_.bind();
    coordinates_.set("world_to_local", glm::inverse(scene_.volume->to_world));
    forward_.draw_geometry(camera_, coordinates_);
    target_.framebuffer.bind();
    forward_.draw_shaded(camera_, true);
    if (with_hulls) draw_hulls();
    timer.end_frame();
    gl::check("bench", "bare hulls");
  }

  /// Fragments of front faces that pass the depth test, of one frame.
  double count_blends() {
    GLuint query = 0;
    glCreateQueries(GL_SAMPLES_PASSED, 1, &query);
    gl::PassTimer untimed;
    render(untimed, false);
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

 private:
  void cut(const HullCounts& counts) {
    geometry_.fit(*scene_.volume, camera_, BoxCut::hulls, counts.hulls);
    const glm::mat4 world_to_view = camera_.world_to_view();
    const auto range = depth_range(BoxDepth(scene_.volume->to_world, world_to_view), camera_.view.near_m);
    if (!range) return;
    const glm::vec3 axis = -glm::vec3(world_to_view[0][2], world_to_view[1][2], world_to_view[2][2]);
    const auto step_m = static_cast<float>((range->back - range->front) / (counts.hulls * counts.samples));
    step_local_ = glm::mat3(glm::inverse(scene_.volume->to_world)) * (axis * step_m);
  }

  void compile(const HullCounts& counts) {
    const std::string box = "algorithms/shaders/box.vert.glsl";
    coordinates_ = gl::Program("bench coordinates", {"algorithms/shaders/opaque.vert.glsl",
                                                     "algorithms/sampling_hulls/coordinates.frag.glsl"});
    back_ = gl::Program("bench back", {box, "algorithms/shaders/bench/bare_back.frag.glsl"});
    gl::Defines defines = medium_.defines(forward_.light_defines());
    auto defined = [&](std::string_view wanted) {
      return std::any_of(defines.begin(), defines.end(), [&](const auto& define) { return define.first == wanted; });
    };
    int shadow_fetches = 0;
    if (defined("SHADOWS")) {
      shadow_fetches = shadow_lookups(scene_) * (counts.filter_occlusion ? 2 * counts.samples + 1 : counts.samples);
    }
    const int maps = 1 + (defined("TRANSFER") ? 1 : 0) + (defined("LIGHT_SPACE") ? 1 : 0);
    fetches_per_blend_ = 1 + maps * counts.samples + shadow_fetches;
    defines.emplace_back("SAMPLES", fmt::to_string(counts.samples));
    defines.emplace_back("SHADOW_FETCHES", fmt::to_string(shadow_fetches));
    front_ = gl::Program("bench front", {box, "algorithms/shaders/bench/bare_front.frag.glsl"}, defines);
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
  ShadowSettings shadow_;
  ForwardPass forward_;
  Medium medium_;
  BoxGeometry geometry_;
  glm::vec3 step_local_{0.0F};
  BenchTarget target_;
  gl::Texture map_;
  gl::Framebuffer map_framebuffer_;
  gl::Program coordinates_, back_, front_;
  int fetches_per_blend_ = 0;
};

double block_median(const std::vector<double>& samples, std::size_t first, std::size_t count) {
  std::vector<double> block(samples.begin() + static_cast<std::ptrdiff_t>(first),
                            samples.begin() + static_cast<std::ptrdiff_t>(first + count));
  std::sort(block.begin(), block.end());
  return quantile(block, 0.5);
}

// sampling_hulls.cpp chooses the same way.
gl::Format map_format(const Scene& scene, const std::string& choice) {
  const glm::ivec3 size = scene.volume->size;
  const bool small = std::max({size.x, size.y, size.z}) < 256;
  return choice == "unorm8" || (choice == "automatic" && small) ? gl::Format::rgba8 : gl::Format::rgba32f;
}

}  // namespace

std::optional<BenchRatio> block_ratio(const std::vector<double>& a, const std::vector<double>& b,
                                      const std::vector<double>& c, int block) {
  assert(block > 0 && a.size() == b.size() && (c.empty() || c.size() == a.size()));
  const auto count = static_cast<std::size_t>(block);
  std::vector<double> ratios;
  for (std::size_t first = 0; first + count <= a.size(); first += count) {
    const double shared = c.empty() ? 0 : block_median(c, first, count);
    const double over = block_median(a, first, count) - shared;
    const double under = block_median(b, first, count) - shared;
    // A block whose noise hides the denominator counts as the greatest; ranks stay defined, and none is left out.
    ratios.push_back(under > 0 ? over / under : std::numeric_limits<double>::infinity());
  }
  if (ratios.empty()) return std::nullopt;
  std::sort(ratios.begin(), ratios.end());
  const Interval ci95 = bootstrap_median_interval(ratios);
  if (!std::isfinite(ci95.high)) return std::nullopt;
  return BenchRatio{quantile(ratios, 0.5), ci95};
}

std::vector<std::vector<double>> time_in_turn(std::span<const FrameClock::Draw> subjects, int frames, FrameClock& clock,
                                              ReferenceTracer* reference) {
  std::vector<std::vector<double>> samples(subjects.size());
  for (const FrameClock::Draw& subject : subjects) {
    WarmUp warm_up(kWarmUpFrames, kWarmUpSeconds / static_cast<double>(subjects.size()));
    std::vector<double> times;
    while (!warm_up.done()) {
      clock.draw(subject, &times);
      clock.drain();
      warm_up.add(times.back());
    }
  }
  if (reference != nullptr) {
    reference->trace();
    reference->forget();
  }
  const int blocks = (frames + BenchResult::kBlockFrames - 1) / BenchResult::kBlockFrames;
  for (int block = 0; block < blocks; ++block) {
    for (std::size_t i = 0; i < subjects.size(); ++i) {
      clock.draw(subjects[i], nullptr);  // the first finds the other's textures in the caches
      for (int frame = 0; frame < BenchResult::kBlockFrames; ++frame)
        clock.draw(subjects[i], &samples[i]);
      if (i > 0 || reference == nullptr) continue;
      clock.drain();
      reference->trace();
    }
  }
  clock.drain();
  return samples;
}

void time_subjects(const std::array<FrameClock::Draw, 3>& subjects, int frames, ReferenceTracer* reference,
                   BenchResult& result) {
  FrameClock clock;
  const std::vector<std::vector<double>> samples = time_in_turn(subjects, frames, clock, reference);
  result.frames = static_cast<int>(samples[0].size());
  result.clock = gl::name(clock.clock());
  result.method = summarise(samples[0]);
  result.bare = summarise(samples[1]);
  result.opaque = summarise(samples[2]);
  const auto ratio = block_ratio(samples[0], samples[1], {}, BenchResult::kBlockFrames);
  assert(ratio);  // every time is positive
  result.ratio = *ratio;
  result.own = block_ratio(samples[0], samples[1], samples[2], BenchResult::kBlockFrames);
  if (reference != nullptr) result.reference = reference->against(samples[0], BenchResult::kBlockFrames);
}

void check_frames(const BenchRequest& request) {
  if (request.frames >= 2 * BenchResult::kBlockFrames) return;
  throw InputError(fmt::format("bench: frames = {} is below {}, the least that has an interval", request.frames,
                               2 * BenchResult::kBlockFrames));
}

RenderSession bench_session(const BenchRequest& request, const char* technique, ParameterRef parameters,
                            nlohmann::json& recipe) {
  RenderSession session(load_scene(request.scene), technique, request.view, request.width, request.height);
  for (const auto& [name, value] : request.settings) {
    session.assign_text(name, value);
    if (const ParameterInfo* info = parameters.table->find(name)) {
      parameters.assign(name, parse_value(*info, value, technique), technique);
    } else if (!name.starts_with("scene.") && name != "frame.format") {
      throw InputError(
          fmt::format("bench: {} of {} is timed with the default of '{}'", technique, request.scene, name));
    }
  }
  session.prepare();
  gl::PassTimer untimed;
  session.render(untimed);
  recipe = {{"technique", technique},
            {"scene", request.scene},
            {"view", session.camera().view.name},
            {"width", request.width},
            {"height", request.height},
            {"parameters", session.parameters()},
            {"scene_hash", session.scene().content_hash()}};
  return session;
}

BenchResult bench_sampling_hulls(const BenchRequest& request, nlohmann::json& recipe) {
  check_frames(request);
  RenderSession session(load_scene(request.scene), kTechnique, request.view, request.width, request.height);
  ShadowSettings shadow;
  constexpr std::string_view kShadowPrefix = "shadow.";
  for (const auto& [name, value] : request.settings) {
    session.assign_text(name, value);
    if (!name.starts_with(kShadowPrefix)) continue;
    const ParameterRef table = bind_parameters(shadow);
    const std::string local = name.substr(kShadowPrefix.size());
    table.assign(local, parse_value(*table.table->find(local), value, "shadow"), "shadow");
  }
  session.prepare();
  gl::PassTimer untimed;
  session.render(untimed);

  const nlohmann::json parameters = session.parameters();
  const Scene& scene = session.scene();
  const Camera& camera = session.camera();
  BareHulls bare(scene, camera, shadow,
                 {parameters.at("hulls").get<int>(), parameters.at("samples").get<int>(),
                  parameters.at("filter_occlusion").get<bool>()},
                 session.color().format(), map_format(scene, parameters.at("coordinates").get<std::string>()));
  recipe = {{"technique", kTechnique},           {"scene", request.scene},
            {"view", camera.view.name},          {"width", request.width},
            {"height", request.height},          {"parameters", parameters},
            {"scene_hash", scene.content_hash()}};

  BenchResult result;
  const double pixels = static_cast<double>(request.width) * request.height;
  result.blends_per_pixel = bare.count_blends() / pixels;
  result.fetches_per_blend = bare.fetches_per_blend();
  result.fetches_per_pixel = result.blends_per_pixel * result.fetches_per_blend;

  const std::array<FrameClock::Draw, 3> subjects{[&](gl::PassTimer& timer) { session.render(timer); },
                                                 [&](gl::PassTimer& timer) { bare.render(timer, true); },
                                                 [&](gl::PassTimer& timer) { bare.render(timer, false); }};
  time_subjects(subjects, request.frames, nullptr, result);
  return result;
}

}  // namespace pellucid::sweeps
