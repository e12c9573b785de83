#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/distance_impostors/distance_impostors.hpp"
#include "algorithms/distance_impostors/dynamic_objects.hpp"
#include "algorithms/raster/forward_pass.hpp"
#include "algorithms/render_session.hpp"
#include "gl/context.hpp"
#include "gl/error.hpp"
#include "sweeps/bench/bench_subjects.hpp"

namespace pellucid::sweeps {
namespace {

using namespace distance_impostors;

constexpr const char* kName = "distance_impostors";

/// Opaque objects, and over them the optical ones with maps that were drawn once.
class ImpostorFrame {
 public:
  ImpostorFrame(const Scene& scene, const Camera& camera, const MapSettings& maps, LookupSettings lookup, bool bare,
                gl::Format format)
      : scene_(scene), camera_(camera), maps_(maps), lookup_(lookup), forward_(scene), target_(camera, format) {
    lookup_.bare = bare;
    forward_.update_shadows(scene, shadow_);
    objects_.prepare(scene, maps_, lookup_.bounces > 1, kName);
    const std::vector<std::size_t> due = objects_.due(scene, maps_);
    objects_.draw_maps(scene, forward_, maps_, lookup_, due);
    objects_.draw_mutual(scene, forward_, maps_, lookup_, due);
  }

  void render(gl::PassTimer& timer, bool with_objects) {
    timer.begin_frame();
    if (forward_.shadowed()) forward_.update_shadows(scene_, shadow_);
    target_.framebuffer.bind();
    forward_.draw_shaded(camera_, false);
    if (with_objects) objects_.draw(scene_, forward_, camera_, target_.target(), maps_, lookup_);
    timer.end_frame();
    gl::check("bench", kName);
  }

  double count_pixels() {
    gl::PassTimer untimed;
    render(untimed, false);
    objects_.draw_surfaces(scene_, forward_, camera_, target_.target());
    GLuint query = 0;
    glCreateQueries(GL_SAMPLES_PASSED, 1, &query);
    glBeginQuery(GL_SAMPLES_PASSED, query);
    objects_.shade(scene_, camera_, target_.target(), maps_, lookup_);
    glEndQuery(GL_SAMPLES_PASSED);
    GLuint64 passed = 0;
    glGetQueryObjectui64v(query, GL_QUERY_RESULT, &passed);
    glDeleteQueries(1, &query);
    return static_cast<double>(passed);
  }

 private:
  const Scene& scene_;
  Camera camera_;
  MapSettings maps_;
  LookupSettings lookup_;
  ShadowSettings shadow_;
  ForwardPass forward_;
  DynamicObjects objects_;
  BenchTarget target_;
};

// As far as the frame follows light: into an object, `internal` times on inside, out, and on by the pictures of the
// other objects in its maps, each of which shows one object more.
SurfaceOptions reference_options(const Scene& scene, const LookupSettings& lookup, const MapSettings& maps) {
  int objects = 0;
  bool solid = false;
  for (const Instance& instance : scene.instances) {
    if (!optical(scene, instance)) continue;
    ++objects;
    solid = solid || material_of(scene, instance).kind == SurfaceKind::dielectric;
  }
  SurfaceOptions options;
  options.both_sides = lookup.bounces > 1;
  options.reflections = options.both_sides ? lookup.internal : 0;
  const int of_one = solid && options.both_sides ? 2 + lookup.internal : 1;
  options.depth = of_one * (objects > 1 ? 1 + maps.mutual : 1);
  return options;
}

}  // namespace

BenchResult bench_distance_impostors(const BenchRequest& request, nlohmann::json& recipe) {
  check_frames(request);
  Parameters parameters;
  RenderSession session = bench_session(request, kName, bind_parameters(parameters), recipe);
  const Scene& scene = session.scene();
  const Camera& camera = session.camera();

  const MapSettings maps = map_settings(parameters);
  const LookupSettings lookup = lookup_settings(parameters);
  const gl::Format format = session.color().format();
  ImpostorFrame method(scene, camera, maps, lookup, false, format), bare(scene, camera, maps, lookup, true, format);
  ReferenceTracer reference(scene, camera, reference_options(scene, lookup, maps));
  BenchResult result;
  result.blends_per_pixel = method.count_pixels() / (static_cast<double>(request.width) * request.height);
  result.fetches_per_blend = fetches(lookup.search) + 1;
  result.fetches_per_pixel = result.blends_per_pixel * result.fetches_per_blend;
  time_subjects({[&](gl::PassTimer& timer) { method.render(timer, true); },
                 [&](gl::PassTimer& timer) { bare.render(timer, true); },
                 [&](gl::PassTimer& timer) { bare.render(timer, false); }},
                request.frames, request.reference ? &reference : nullptr, result);
  return result;
}

}  // namespace pellucid::sweeps
