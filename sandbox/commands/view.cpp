// pellucid view, and the hidden renderer behind its window.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "algorithms/scene/images/frame_size.hpp"
#include "algorithms/scene/images/image.hpp"
#include "algorithms/technique.hpp"
#include "gl/error.hpp"
#include "gl/resources/resources.hpp"
#include "sandbox/arguments.hpp"
#include "sandbox/commands/commands.hpp"
#include "sandbox/viewer/app/viewer.hpp"
#include "sandbox/viewer/live/render_worker.hpp"

namespace pellucid::sandbox {
namespace {

struct ViewArguments {
  std::string scene, technique, view, size = "720x540", window;
  std::vector<std::string> settings;
  std::filesystem::path shaders;
  float ui_scale = 0;
  ViewerOptions viewer;
};

Value value_of_text(const std::string& technique, const std::string& name, const std::string& text) {
  if (name.find('.') != std::string::npos) {
    // The scene's tables are known to the renderer, which judges; a number stays a number.
    ParameterInfo real;
    real.name = name;
    real.min = -1e300;
    real.max = 1e300;
    if (text == "true" || text == "false") return text == "true";
    try {
      return parse_value(real, text, name);
    } catch (const InputError&) {
      return text;
    }
  }
  const ParameterTable& table = find_technique(technique).table();
  const ParameterInfo* info = table.find(name);
  if (info == nullptr) throw unknown_parameter(name, technique, table.infos());
  return parse_value(*info, text, technique);
}

ViewState initial_state(const ViewArguments& options, const cli::App& app) {
  ViewState state;
  if (options.scene.ends_with(".exr")) {
    state = state_of_file(read_image(options.scene), options.scene);
    if (!options.technique.empty() && options.technique != state.technique) {
      state.technique = find_technique(options.technique).name;
      std::erase_if(state.parameters, [](const auto& entry) { return entry.first.find('.') == std::string::npos; });
    }
    if (!options.view.empty()) state.view = options.view;
  } else {
    state.scene = options.scene;
    state.technique = options.technique.empty() ? std::string(techniques().front().name) : options.technique;
    state.view = options.view;
  }
  if (app.count("--size") > 0 && options.size != "window") {
    const FrameSize size = parse_frame_size(options.size, "--size");
    state.width = size.width;
    state.height = size.height;
  }
  find_technique(state.technique);
  for (const std::string& setting : options.settings) {
    const auto [name, value] = parse_assignment(setting);
    state.parameters[name] = value_of_text(state.technique, name, value);
  }
  return state;
}

/// Shaders that a measurement may save again and again; the folder goes with it.
class ScratchShaders {
 public:
  explicit ScratchShaders(const std::string& technique)
      : root_(std::filesystem::temp_directory_path() / fmt::format("pellucid_measure_{}", ::getpid())) {
    for (const std::string& name : list_resources("algorithms/" + technique + "/", ".frag.glsl")) {
      std::filesystem::create_directories((root_ / name).parent_path());
      std::ofstream(root_ / name) << find_resource(name).value_or("");
    }
    std::filesystem::create_directories(root_);
  }
  ~ScratchShaders() {
    std::error_code ignored;
    std::filesystem::remove_all(root_, ignored);
  }
  ScratchShaders(const ScratchShaders&) = delete;
  ScratchShaders& operator=(const ScratchShaders&) = delete;
  const std::filesystem::path& root() const { return root_; }

 private:
  std::filesystem::path root_;
};

int view(ViewArguments options, const cli::App& app) {
  options.viewer.state = initial_state(options, app);
  options.viewer.size_follows_window = options.size == "window";
  if (!options.window.empty()) {
    const FrameSize size = parse_frame_size(options.window, "--window");
    options.viewer.window_width = size.width;
    options.viewer.window_height = size.height;
  }
  if (options.ui_scale > 0) options.viewer.ui_scale = options.ui_scale;
  std::optional<ScratchShaders> scratch;
  if (options.viewer.measure) {
    if (!options.shaders.empty())
      throw InputError("--measure saves shaders in a folder of its own; leave --shaders out");
    scratch.emplace(options.viewer.state.technique);
    options.shaders = scratch->root();
  }
  if (!options.shaders.empty()) ::setenv("PELLUCID_SHADER_PATH", options.shaders.c_str(), 1);
  if (const char* shaders = std::getenv("PELLUCID_SHADER_PATH")) options.viewer.shaders = shaders;
  return run_viewer(options.viewer);
}

}  // namespace

void add_view(cli::App& root, std::vector<Command>& commands) {
  auto options = std::make_shared<ViewArguments>();
  ViewerOptions& viewer = options->viewer;
  cli::App* app = root.add_subcommand("view", "Open a window on a scene and change everything by hand");
  app->add_option("scene", options->scene,
                  "A scene's name (pellucid list scenes), a .toml file, or an EXR that was rendered")
      ->required();
  app->add_option("-t,--technique", options->technique, "A technique (pellucid list techniques)");
  app->add_option("-s,--set", options->settings,
                  "name=value of a parameter, scene.name for the scene's own; repeatable")
      ->allow_extra_args(false);
  app->add_option("--view", options->view, "A named view, or a camera: eye=X,Y,Z:target=X,Y,Z:fov=DEGREES");
  app->add_option("--size", options->size, "WIDTHxHEIGHT of the picture, or `window`: as large as there is room")
      ->capture_default_str();
  app->add_option("--window", options->window,
                  "WIDTHxHEIGHT of the window; without it the picture and the panel fit in");
  app->add_option("--ui-scale", options->ui_scale, "Size of text and controls; the monitor's own without it")
      ->check(cli::Range(0.5, 4.0));
  app->add_option("--shaders", options->shaders,
                  "Folder, laid out as the source tree, whose shaders replace the embedded ones")
      ->check(cli::ExistingDirectory);
  app->add_option("--folder", viewer.folder, "Where pictures and stores are saved")
      ->check(cli::ExistingDirectory)
      ->capture_default_str();
  app->add_option("--exposure", viewer.exposure_ev, "Stops by which the picture is brightened")
      ->check(cli::Range(-64.0, 64.0));
  app->add_option("--display", viewer.display, "OpenColorIO display; the config's default without it");
  app->add_option("--display-view", viewer.display_view, "OpenColorIO view; the config's default without it");
  app->add_option("--look", viewer.look, "OpenColorIO look; none without it");
  app->add_option("--device", viewer.device, "EGL device of the renderer (pellucid devices)");
  app->add_option("--compare", viewer.compare, "Compare with a technique, `reference`, or a picture's file");
  app->add_option("--tev", viewer.tev, "HOST:PORT of a tev or HDRView window that shows each picture too");
  auto* random = app->add_option("--random-tweaks", viewer.random_tweaks,
                                 "Turn every knob at random from this seed, check that each picture is of the panel's "
                                 "state, and close");
  app->add_option("--seconds", viewer.tweak_seconds, "How long")->needs(random)->capture_default_str();
  auto* measure = app->add_flag("--measure", viewer.measure,
                                "Measure the window itself, print the figures and close; status 3 when one misses");
  app->add_flag("--json", viewer.json, "The figures as JSON")->needs(measure);
  app->add_option("--lose-context-at", viewer.lose_context_at,
                  "For tests: treat the window's graphics context as lost after so many pictures");
  app->add_option("--log", viewer.log, "Write what the window shows, as JSON lines, for tests and reports of faults");
  app->footer(
      "Examples:\n"
      "  pellucid view fog_forest -t volume_slices\n"
      "  pellucid view picture.exr          the exact state that made the picture\n"
      "  pellucid view fog_forest -t volume_slices --measure\n"
      "Press ? in the window for its keys.");
  commands.push_back({app, [options, app] { return view(*options, *app); }});

  auto device = std::make_shared<std::optional<int>>();
  cli::App* renderer = root.add_subcommand("view-renderer", "Draw what the window asks for");
  renderer->group("");  // not for people
  renderer->add_option("--device", *device, "EGL device");
  commands.push_back({renderer, [device] { return run_render_worker(*device); }});
}

}  // namespace pellucid::sandbox
