#include "sandbox/viewer/live/render_worker.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <exception>
#include <iostream>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/progress.hpp"
#include "algorithms/render_session.hpp"
#include "algorithms/scene/files/tell.hpp"
#include "algorithms/scene/loading_facts.hpp"
#include "algorithms/scene/view_text.hpp"
#include "gl/context.hpp"
#include "gl/error.hpp"
#include "gl/live_objects.hpp"
#include "sandbox/viewer/live/keep_memory.hpp"
#include "sandbox/viewer/live/shared_pixels.hpp"
#include "sandbox/viewer/state/parameter_json.hpp"
#include "sandbox/viewer/state/view_state.hpp"
#include "sweeps/measure/reference_methods.hpp"
#include "sweeps/spec/point_json.hpp"
#include "sweeps/workers/worker_protocol.hpp"

namespace pellucid::sandbox {
namespace {

using nlohmann::json;

// From any thread.
void tell(const json& message) {
  static std::mutex writing;
  const std::scoped_lock lock(writing);
  std::cout << sweeps::to_line(message) << std::endl;
}

json triple_json(const glm::vec3& v) {
  return {v.x, v.y, v.z};
}

class RenderWorker {
 public:
  explicit RenderWorker(const gl::Context& context) : context_(context), first_objects_(gl::count_live_objects()) {}

  void render(const json& request) {
    generation_ = request.at("generation");
    const ViewState state = from_recipe(request.at("recipe"), "recipe");
    counts_ = request.value("counts", false);
    follow(state, request.value("scene", false));
    if (precompute_) phase("precomputing");
    const double prepare_s = [&] {
      const ProgressListener listener(
          [this](std::string_view work, double share) { progress(fmt::format("precomputing, {}", work), share); });
      return session_->prepare();
    }();
    if (std::exchange(precompute_, false)) phase("drawing");
    gl::PassTimer timer(gl::Detail::passes);
    session_->render(timer);
    const auto time = timer.wait();
    const Image image = session_->read_color();

    json answer = picture(image);
    answer["prepare_s"] = prepare_s;
    answer["frame_ms"] = time->frame_ms;
    answer["pass_ms"] = json::array();
    for (const auto& [pass, ms] : time->pass_ms)
      answer["pass_ms"].push_back({pass, ms});
    answer["clock"] = gl::name(timer.clock());
    answer["native_errors"] = json::object();
    std::vector<std::span<const float>> parts{image.pixels};
    std::vector<NativeMap> maps;
    if (request.value("maps", false)) {
      session_->technique().native_errors(answer["native_errors"]);
      maps = session_->technique().native_maps();
    }
    if (counts_) {
      answer["objects"] = gl::count_live_objects();
      answer["objects_left"] = objects_left_;
    }
    answer["maps"] = json::array();
    for (const NativeMap& map : maps) {
      answer["maps"].push_back({{"name", map.name},
                                {"unit", map.unit},
                                {"doc", map.doc},
                                {"classes", map.classes},
                                {"width", map.values.width},
                                {"height", map.values.height}});
      parts.emplace_back(map.values.pixels);
    }
    write_shared_pixels(request.at("memory"), parts);
    tell(answer);
  }

  void reference(const json& request) {
    generation_ = request.at("generation");
    ViewState state = from_recipe(request.at("recipe"), "recipe");
    const int divide = request.at("divide");
    state.width = std::max(1, state.width / divide);
    state.height = std::max(1, state.height / divide);
    follow(state, false);
    phase("tracing the reference");
    Scene& scene = session_->scene();
    sweeps::ReferenceSettings settings;
    settings.samples = has_interfaces(scene) ? request.at("samples").get<int>() : 1;
    settings = sweeps::settled(settings, scene.name, has_interfaces(scene), scene.volume.has_value());
    const std::string work = "tracing the reference";
    ReferenceOptions options;
    options.progress = [&](double share) { progress(work, share); };
    const SurfaceLayer surfaces = sweeps::reference_surfaces(*session_, settings, options.progress);
    const Reference exact = render_reference(scene, session_->camera(), surfaces, options);
    json answer = picture(exact.image);
    answer["quality"] = settings.surfaces == sweeps::ReferenceSurfaces::rays
                            ? fmt::format("{} rays per pixel, standard error {:.2g}", settings.samples,
                                          exact.surfaces.standard_error_mean)
                            : fmt::format("{}x{}, step error {:.2g}", state.width, state.height, exact.step_error_max);
    write_shared_pixels(request.at("memory"), std::vector<std::span<const float>>{exact.image.pixels});
    tell(answer);
  }

  void reload() { tell({{"type", "shaders"}, {"error", session_ ? session_->reload_shaders() : std::string{}}}); }

  std::uint64_t generation() const { return generation_; }

 private:
  void phase(const std::string& words) { tell({{"type", "phase"}, {"generation", generation_}, {"words", words}}); }

  // A few times a second; from any thread.
  void progress(const std::string& words, double share) {
    const std::scoped_lock lock(telling_);
    const auto now = std::chrono::steady_clock::now();
    if (now - told_ < std::chrono::milliseconds(100)) return;
    told_ = now;
    tell({{"type", "phase"}, {"generation", generation_}, {"words", words}, {"share", share}});
  }

  json picture(const Image& image) {
    json recipe = to_recipe({session_scene_,
                             std::string(session_->technique_info().name),
                             session_->camera().view.name,
                             session_->camera().width,
                             session_->camera().height,
                             {}});
    recipe["parameters"] = session_->parameters();
    return {{"type", "picture"},
            {"generation", generation_},
            {"recipe", recipe},
            {"width", image.width},
            {"height", image.height},
            {"channels", image.channels},
            {"gpu_bytes", gl::allocated_bytes()},
            {"scene_hash", session_->scene().content_hash()},
            {"device", context_.device().renderer},
            {"driver", context_.device().version}};
  }

  // Brings the session to `state` with as little work as it can.
  void follow(const ViewState& state, bool tell_facts) {
    const bool has_scene = session_ && session_scene_ == state.scene;
    if (has_scene && tell_facts) tell_scene(state.scene, session_->scene());
    if (!session_ || session_scene_ != state.scene || session_->technique_info().name != state.technique) {
      // A wrong name is told before the scene loads.
      find_technique(state.technique);
      phase(fmt::format("loading {}", state.scene));
      if (session_) {
        session_.reset();
        if (counts_) objects_left_ = gl::growth(first_objects_, gl::count_live_objects());
      }
      Scene scene = load_scene(state.scene);
      for (const std::string& warning : loading_facts(scene).warnings)
        tell_line("warning: " + warning);
      if (!has_scene || !tell_facts) tell_scene(state.scene, scene);
      phase("compiling shaders");
      session_.emplace(std::move(scene), state.technique, state.view, state.width, state.height);
      session_scene_ = state.scene;
      assigned_.clear();
      precompute_ = true;
    }
    for (auto it = assigned_.begin(); it != assigned_.end();) {
      if (state.parameters.contains(it->first)) {
        ++it;
      } else {
        assign(it->first, it->second.standard);
        it = assigned_.erase(it);
      }
    }
    for (const auto& [name, value] : state.parameters) {
      const auto known = assigned_.find(name);
      if (known != assigned_.end() && known->second.value == value) continue;
      if (known == assigned_.end()) {
        const json current = session_->parameters();
        if (!current.contains(name)) {
          assign(name, value);  // throws, with the nearest name
          continue;
        }
        const Value standard = sweeps::value_from_json(current.at(name));
        if (same(standard, value)) continue;
        assign(name, value);
        assigned_[name] = {value, standard};
      } else {
        assign(name, value);
        known->second.value = value;
      }
    }
    session_->set_view(view_of(session_->scene(), state.view));
    session_->resize(state.width, state.height);
  }

  // A real that is whole travels as an integer.
  static bool same(const Value& a, const Value& b) { return to_text(a) == to_text(b); }

  void assign(const std::string& name, const Value& value) {
    if (session_->assign(name, value) == Change::precompute) precompute_ = true;
  }

  void tell_scene(const std::string& name, Scene& scene) {
    json views = json::array();
    for (const View& view : scene.views) {
      views.push_back({{"name", view.name},
                       {"eye", triple_json(view.eye)},
                       {"target", triple_json(view.target)},
                       {"up", triple_json(view.up)},
                       {"fov_y_deg", view.fov_y_deg},
                       {"near_m", view.near_m},
                       {"far_m", view.far_m}});
    }
    tell({{"type", "scene"},
          {"generation", generation_},
          {"scene", name},
          {"views", views},
          {"parameters", parameters_json(scene.parameters().infos())}});
  }

  struct Assigned {
    Value value, standard;
  };
  const gl::Context& context_;
  std::optional<RenderSession> session_;
  std::string session_scene_;
  std::map<std::string, Assigned> assigned_;
  bool precompute_ = false;
  bool counts_ = false;
  gl::LiveObjects first_objects_;  // before the first session
  std::string objects_left_;       // more than those, after the last one
  std::uint64_t generation_ = 0;
  std::mutex telling_;
  std::chrono::steady_clock::time_point told_{};
};

}  // namespace

int run_render_worker(std::optional<int> device) {
  keep_freed_memory();
  const gl::Context context({.device = device});
  tell({{"type", "hello"}, {"device", context.device().renderer}, {"driver", context.device().version}});
  // A warning belongs into the window.
  const TellListener told([](std::string_view line) { tell({{"type", "told"}, {"words", line}}); });
  RenderWorker worker(context);
  for (std::string line; std::getline(std::cin, line);) {
    const json request = json::parse(line);
    const std::string type = request.at("type");
    try {
      if (type == "render") {
        worker.render(request);
      } else if (type == "reference") {
        worker.reference(request);
      } else {
        worker.reload();
      }
    } catch (const InputError& e) {
      tell({{"type", "refused"}, {"generation", worker.generation()}, {"reason", e.what()}});
    } catch (const std::exception& e) {
      tell({{"type", "refused"}, {"generation", worker.generation()}, {"reason", e.what()}, {"failed", true}});
      return 1;
    }
  }
  return 0;
}

}  // namespace pellucid::sandbox
