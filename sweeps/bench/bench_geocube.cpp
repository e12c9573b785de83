#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/geocube/glass_pass.hpp"
#include "algorithms/raster/forward_pass.hpp"
#include "algorithms/render_session.hpp"
#include "gl/context.hpp"
#include "gl/error.hpp"
#include "sweeps/bench/bench_subjects.hpp"

namespace pellucid::sweeps {
namespace {

using namespace geocube;

constexpr const char* kName = "geocube";

/// The technique's frame with its cubes made once, and the same with the bare shader in place of the search.
class GlassFrame {
 public:
  GlassFrame(const Scene& scene, const Camera& camera, const Parameters& parameters, gl::Format format)
      : scene_(scene), camera_(camera), forward_(scene), pass_(parameters), target_(camera, format) {
    forward_.update_shadows(scene, shadow_);
    pass_.prepare(scene);
  }

  enum class Shader { search, bare, none };
  void render(gl::PassTimer& timer, Shader shader) {
    timer.begin_frame();
    if (forward_.shadowed()) forward_.update_shadows(scene_, shadow_);
    pass_.draw_entries(scene_, camera_, forward_, target_.target(), timer);
    if (shader == Shader::search) pass_.draw_glass(scene_, camera_, target_.target());
    if (shader == Shader::bare) pass_.draw_bare(scene_, camera_, target_.target());
    timer.end_frame();
    gl::check("bench", kName);
  }

  FetchCounts count_fetches() {
    gl::PassTimer untimed;
    render(untimed, Shader::none);
    return pass_.count_fetches(scene_, camera_, forward_);
  }

 private:
  const Scene& scene_;
  Camera camera_;
  ShadowSettings shadow_;
  ForwardPass forward_;
  GlassPass pass_;
  BenchTarget target_;
};

}  // namespace

BenchResult bench_geocube(const BenchRequest& request, nlohmann::json& recipe) {
  check_frames(request);
  Parameters parameters;
  RenderSession session = bench_session(request, kName, bind_parameters(parameters), recipe);
  const Scene& scene = session.scene();
  const Camera& camera = session.camera();

  GlassFrame frame(scene, camera, parameters, session.color().format());
  const FetchCounts counts = frame.count_fetches();
  if (counts.pixels == 0) {
    throw InputError(fmt::format("bench: {} shows no dielectric in view {}, {}x{}", request.scene, camera.view.name,
                                 request.width, request.height));
  }
  BenchResult result;
  const double pixels = static_cast<double>(request.width) * request.height;
  result.blends_per_pixel = counts.pixels / pixels;
  result.fetches_per_blend = counts.fetches / counts.pixels;
  result.fetches_per_pixel = counts.fetches / pixels;
  // As far as the frame follows light: in, `reflections` times on inside, and out.
  SurfaceOptions options;
  options.reflections = parameters.reflections;
  options.depth = 2 + parameters.reflections;
  options.cut = static_cast<double>(parameters.cut);
  ReferenceTracer reference(scene, camera, options);
  using Shader = GlassFrame::Shader;
  time_subjects({[&](gl::PassTimer& timer) { frame.render(timer, Shader::search); },
                 [&](gl::PassTimer& timer) { frame.render(timer, Shader::bare); },
                 [&](gl::PassTimer& timer) { frame.render(timer, Shader::none); }},
                request.frames, request.reference ? &reference : nullptr, result);
  return result;
}

}  // namespace pellucid::sweeps
