// A technique of volumes against VTK's volume rendering at equal error.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <epoxy/gl.h>
#include <fmt/format.h>

#include "algorithms/bare_frame.hpp"
#include "algorithms/parameter_names.hpp"
#include "algorithms/reference/reference.hpp"
#include "algorithms/render_session.hpp"
#include "algorithms/technique.hpp"
#include "gl/context.hpp"
#include "gl/error.hpp"
#include "sweeps/bench/bench.hpp"
#include "sweeps/bench/vtk_volume.hpp"
#include "sweeps/measure/frame_clock.hpp"

namespace pellucid::sweeps {
namespace {

constexpr int kVtkWarmUpFrames = 3;
constexpr int kHalvings = 16;
constexpr int kBisections = 6;
constexpr double kLongestFrame_s = 10;

double rms_error(const Image& image, const Reference& reference) {
  double sum = 0, count = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (reference.mask.at(x, y)[0] == 0) continue;
      for (int c = 0; c < 3; ++c) {
        const double e = static_cast<double>(image.at(x, y)[c]) - static_cast<double>(reference.image.at(x, y)[c]);
        sum += e * e;
        ++count;
      }
    }
  }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

void draw_timed(VtkVolume& volume, gl::PassTimer& timer) {
  timer.begin_frame();
  volume.render();
  // VTK leaves errors behind that it does not mind; the picture is judged by its distance from the reference.
  while (glGetError() != GL_NO_ERROR) {
  }
  timer.end_frame();
}

/// The sample distance at which VTK's error is that of the other, or its least.
struct Match {
  double sample_distance_m = 0;
  double rms_error = std::numeric_limits<double>::infinity();
};

class Search {
 public:
  Search(VtkVolume& volume, const Reference& reference) : volume_(volume), reference_(reference) {}

  Match find(double longest_m, double wanted) {
    double good = longest_m, bad = 0;  // sample distances
    Match best = measure(good);
    for (int i = 0; i < kHalvings && best.rms_error > wanted && last_s_ < kLongestFrame_s; ++i) {
      bad = good;
      good /= 2;
      const Match at = measure(good);
      if (at.rms_error < best.rms_error) best = at;
    }
    if (best.rms_error > wanted) return best;
    for (int i = 0; i < kBisections && bad > 0; ++i) {
      const Match at = measure(std::sqrt(good * bad));
      (at.rms_error <= wanted ? good : bad) = at.sample_distance_m;
      if (at.rms_error <= wanted) best = at;
    }
    return best;
  }

 private:
  Match measure(double distance_m) {
    volume_.set_sample_distance(distance_m);
    gl::PassTimer timer(gl::Detail::frame);
    draw_timed(volume_, timer);
    last_s_ = timer.wait()->frame_ms / 1e3;
    return {distance_m, rms_error(volume_.read_color(), reference_)};
  }

  VtkVolume& volume_;
  const Reference& reference_;
  double last_s_ = 0;
};

/// The scene's volume alone in a black world, white where it is opaque.
void keep_medium_alone(Scene& scene) {
  if (!scene.volume) throw InputError(fmt::format("bench: the scene '{}' has no volume", scene.name));
  scene.instances.clear();
  scene.lights.clear();
  scene.environment = {};
  scene.ambient = glm::vec3(1.0F);
  Volume& volume = *scene.volume;
  volume.albedo = glm::vec3(1.0F);
  volume.emission = glm::vec3(0.0F);
  volume.light = -1;
  volume.scattering.clear();
  for (TransferPoint& point : volume.transfer)
    point.albedo = glm::vec3(1.0F);
}

RenderSession open(const TechniqueInfo& technique, const BenchRequest& request) {
  Scene scene = load_scene(request.scene.empty() ? bare_frame_of(technique).scene : request.scene);
  for (const auto& [name, value] : request.settings) {
    const auto [owner, local] = route(name);
    if (owner != ParameterOwner::scene) continue;
    const ParameterRef table = scene.parameters();
    const ParameterInfo* info = table.table->find(local);
    if (info == nullptr) throw unknown_parameter(local, "scene " + scene.name, table.infos());
    table.assign(local, parse_value(*info, value, "scene " + scene.name), "scene " + scene.name);
  }
  keep_medium_alone(scene);
  RenderSession session(std::move(scene), technique.name, request.view, request.width, request.height);
  for (const auto& [name, value] : request.settings) {
    if (route(name).owner != ParameterOwner::scene) session.assign_text(name, value);
  }
  return session;
}

}  // namespace

BenchVtk bench_against_vtk(const TechniqueInfo& technique, const BenchRequest& request, gl::Context& context) {
  context.make_current();
  RenderSession session = open(technique, request);
  gl::PassTimer untimed;
  session.render(untimed);
  const Reference reference = render_reference(session.scene(), session.camera(), session.raster_surfaces());
  BenchVtk result;
  result.method_rmse = rms_error(session.read_color(), reference);
  FrameClock clock;
  const FrameClock::Draw ours = [&](gl::PassTimer& timer) { session.render(timer); };
  std::vector<double> method_ms, vtk_ms;
  {
    gl::Context other({.device = context.device().index, .debug = false});
    VtkVolume volume(*session.scene().volume, session.camera());
    const glm::mat4& to_world = session.scene().volume->to_world;
    const double diagonal_m = std::sqrt(static_cast<double>(
        glm::dot(to_world[0], to_world[0]) + glm::dot(to_world[1], to_world[1]) + glm::dot(to_world[2], to_world[2])));
    const Match match = Search(volume, reference).find(diagonal_m / 2, result.method_rmse);
    result.vtk_rmse = match.rms_error;
    result.sample_distance_m = match.sample_distance_m;
    volume.set_sample_distance(match.sample_distance_m);
    FrameClock vtk_clock;
    const FrameClock::Draw theirs = [&](gl::PassTimer& timer) { draw_timed(volume, timer); };
    auto block = [&](gl::Context& where, FrameClock& with, const FrameClock::Draw& draw, int frames,
                     std::vector<double>* into) {
      where.make_current();
      with.draw(draw, nullptr);  // the first finds the other's textures in the caches
      for (int i = 0; i < frames; ++i)
        with.draw(draw, into);
      with.drain();
    };
    block(context, clock, ours, kVtkWarmUpFrames, nullptr);
    block(other, vtk_clock, theirs, kVtkWarmUpFrames, nullptr);
    for (int frame = 0; frame < request.frames; frame += BenchResult::kBlockFrames) {
      block(context, clock, ours, BenchResult::kBlockFrames, &method_ms);
      block(other, vtk_clock, theirs, BenchResult::kBlockFrames, &vtk_ms);
    }
  }
  context.make_current();
  result.method = summarise(method_ms);
  result.vtk = summarise(vtk_ms);
  result.ratio = *block_ratio(method_ms, vtk_ms, {}, BenchResult::kBlockFrames);  // every time is positive
  return result;
}

}  // namespace pellucid::sweeps
