// pellucid render, reference.
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <unistd.h>

#include "algorithms/render_session.hpp"
#include "gl/context.hpp"
#include "sandbox/commands/arguments.hpp"
#include "sandbox/commands/commands.hpp"
#include "sweeps/provenance.hpp"

namespace pellucid::sandbox {
namespace {

using nlohmann::ordered_json;

struct Options {
  std::string scene, technique, view, size = "720x540", surfaces = "rays";
  std::vector<std::string> settings;
  std::filesystem::path output;
  std::optional<int> device;
  DisplayOptions display;
  double tolerance = ReferenceOptions{}.tolerance;
  int max_steps = ReferenceOptions{}.max_steps;
  bool json = false;
};

void require_finite(const Image& image, const std::string& what) {
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (std::isfinite(image.pixels[i])) continue;
    const std::size_t pixel = i / static_cast<std::size_t>(image.channels);
    throw RuntimeError(fmt::format("{}: pixel ({}, {}) is not a number", what,
                                   pixel % static_cast<std::size_t>(image.width),
                                   pixel / static_cast<std::size_t>(image.width)));
  }
}

// What a file must know to be made again (`pellucid reproduce FILE.exr`), and where it comes from.
ordered_json provenance() {
  return {{"version", PELLUCID_VERSION},
          {"commit", sweeps::kCommit},
          {"dirty", sweeps::kDirty},
          {"started_utc", sweeps::utc_text(sweeps::unix_now_s())},
          {"argv", process_arguments()}};
}

Attributes attributes(const char* command, const ordered_json& recipe, const ordered_json& origin) {
  return {{"pellucid.command", command}, {"pellucid.recipe", recipe.dump()}, {"pellucid.provenance", origin.dump()}};
}

int render(const Options& options) {
  const Size size = parse_size(options.size);
  check_output(options.output, {".exr", ".png"});
  find_technique(options.technique);  // a wrong name is told before the scene loads
  Scene scene = load_scene(options.scene);
  const gl::Context context({.device = options.device});
  RenderSession session(std::move(scene), options.technique, options.view, size.width, size.height);
  for (const std::string& setting : options.settings) {
    const auto [name, value] = parse_assignment(setting);
    session.assign_text(name, value);
  }
  const double prepare_s = session.prepare();
  gl::PassTimer timer(gl::Detail::passes);
  session.render(timer);
  const auto time = timer.wait();
  ImageFile file;
  file.image = session.read_color();
  require_finite(file.image, std::string(session.technique_info().name));

  ordered_json recipe{{"scene", options.scene}, {"technique", options.technique}, {"view", session.camera().view.name},
                      {"width", size.width},    {"height", size.height},          {"parameters", session.parameters()}};
  ordered_json origin = provenance();
  origin["scene_hash"] = session.scene().content_hash();
  origin["device"] = context.device().renderer;
  origin["driver"] = context.device().version;
  file.attributes = attributes("render", recipe, origin);
  write_picture(options.output, file, options.display);

  if (options.json) {
    ordered_json out = recipe;
    // One frame, the first: shaders and caches are cold. Sweeps measure; this only tells that it ran.
    out["first_frame_ms"] = time->frame_ms;
    for (const auto& [pass, ms] : time->pass_ms)
      out["pass_ms"][pass] = ms;
    out["clock"] = gl::name(timer.clock());
    out["prepare_s"] = prepare_s;
    ordered_json native = ordered_json::object();
    nlohmann::json errors = nlohmann::json::object();
    session.technique().native_errors(errors);
    out["native_errors"] = errors;
    out["gpu_bytes"] = gl::allocated_bytes();
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    out["peak_rss_bytes"] = static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
    out["provenance"] = origin;
    out["output"] = options.output.string();
    fmt::print("{}\n", out.dump(2));
  } else {
    fmt::print(stderr, "{}: {} of {}, {}x{}, first frame {:.1f} ms on {}\n", options.output.string(), options.technique,
               options.scene, size.width, size.height, time->frame_ms, context.device().renderer);
  }
  return kDone;
}

int reference(const Options& options) {
  const Size size = parse_size(options.size);
  check_output(options.output, {".exr", ".png"});
  Scene scene = load_scene(options.scene);
  for (const std::string& setting : options.settings) {
    auto [name, value] = parse_assignment(setting);
    if (!name.starts_with("scene.")) {
      throw InputError(
          fmt::format("-s {}: a reference has no technique, so only scene. parameters can be set", setting));
    }
    name.erase(0, std::string_view("scene.").size());
    const ParameterRef table = scene.parameters();
    const ParameterInfo* info = table.table->find(name);
    if (info == nullptr) throw unknown_parameter(name, "scene " + scene.name, table.infos());
    table.assign(name, parse_value(*info, value, "scene " + scene.name), "scene " + scene.name);
  }
  const Camera camera{scene.find_view(options.view), size.width, size.height};
  ReferenceOptions settings;
  settings.tolerance = options.tolerance;
  settings.max_steps = options.max_steps;
  const bool terminal = isatty(STDERR_FILENO) != 0;
  if (terminal) {
    settings.progress = [](double share) { fmt::print(stderr, "\rreference {:3.0f} %", 100 * share); };
  }

  ordered_json origin = provenance();
  origin["scene_hash"] = scene.content_hash();
  SurfaceLayer surfaces;
  if (options.surfaces == "raster") {
    const gl::Context context({.device = options.device});
    RenderSession session(load_scene(options.scene), techniques().front().name, options.view, size.width, size.height);
    for (const std::string& setting : options.settings) {
      const auto [name, value] = parse_assignment(setting);
      session.assign_text(name, value);
    }
    surfaces = session.raster_surfaces();
    origin["device"] = context.device().renderer;
    origin["driver"] = context.device().version;
  } else {
    surfaces = trace_surfaces(scene, camera);
  }
  const Reference result = render_reference(scene, camera, surfaces, settings);
  if (terminal) fmt::print(stderr, "\r");

  ordered_json errors{{"step_error_max", result.step_error_max},
                      {"step_error_mean", result.step_error_mean},
                      {"unconverged_share", result.unconverged_share}};
  nlohmann::json parameters = nlohmann::json::object();
  for (const ParameterInfo& info : scene.parameters().infos()) {
    parameters["scene." + info.name] =
        std::visit([](const auto& v) { return nlohmann::json(v); }, scene.parameters().get(info.name));
  }
  ordered_json recipe{
      {"scene", options.scene},         {"view", camera.view.name},     {"width", size.width},
      {"height", size.height},          {"surfaces", options.surfaces}, {"tolerance", options.tolerance},
      {"max_steps", options.max_steps}, {"parameters", parameters}};
  ImageFile file;
  file.image = result.image;
  file.layers["mask"] = result.mask;
  file.attributes = attributes("reference", recipe, origin);
  file.attributes["pellucid.reference_error"] = errors.dump();
  write_picture(options.output, file, options.display);
  if (options.json) {
    ordered_json out = recipe;
    out.update(errors);
    out["output"] = options.output.string();
    fmt::print("{}\n", out.dump(2));
  } else {
    fmt::print(
        stderr,
        "{}: reference of {}, {}x{}, step error max {:.2g}, mean {:.2g}; {:.3g} % of the pixels above the tolerance\n",
        options.output.string(), options.scene, size.width, size.height, result.step_error_max, result.step_error_mean,
        100 * result.unconverged_share);
  }
  return kDone;
}

void add_common(CLI::App& app, Options& options) {
  app.add_option("scene", options.scene, "A scene's name (pellucid list scenes) or a .toml file")->required();
  app.add_option("-s,--set", options.settings, "name=value of a parameter, scene.name for the scene's own; repeatable")
      ->allow_extra_args(false);
  app.add_option("--view", options.view, "A named view; the first without it");
  app.add_option("--size", options.size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  app.add_option("-o,--output", options.output, "out.exr (scene-linear half) or out.png (display)")->required();
  app.add_option("--device", options.device, "EGL device (pellucid devices)");
  app.add_option("--exposure", options.display.exposure_ev, "Stops by which a PNG is brightened")
      ->capture_default_str();
  app.add_option("--display", options.display.display, "OpenColorIO display of a PNG; the config's default without it");
  app.add_option("--display-view", options.display.view, "OpenColorIO view of a PNG; the config's default without it");
  app.add_flag("--json", options.json, "Print what was done as JSON");
}

}  // namespace

void add_render(CLI::App& root, std::vector<Command>& commands) {
  auto options = std::make_shared<Options>();
  CLI::App* render_app = root.add_subcommand("render", "Render one frame of a scene with a technique");
  add_common(*render_app, *options);
  render_app->add_option("-t,--technique", options->technique, "A technique (pellucid list techniques)")->required();
  render_app->footer(
      "Example: pellucid render fog_forest -t sampling_hulls -s hulls=4 -s samples=8 -o fog.png\n"
      "An EXR carries what made it: pellucid reproduce fog.exr -o DIR renders it again.");
  commands.push_back({render_app, [options] { return render(*options); }});

  auto truth = std::make_shared<Options>();
  CLI::App* reference_app = root.add_subcommand("reference", "Compute the ground truth of a scene on the CPU");
  add_common(*reference_app, *truth);
  reference_app
      ->add_option(
          "--surfaces", truth->surfaces,
          "rays: surfaces traced with Embree; raster: from the forward pass, so that silhouettes are the same as in a "
          "rendering and a metric sees the medium alone")
      ->check(CLI::IsMember({"rays", "raster"}))
      ->capture_default_str();
  reference_app->add_option("--tolerance", truth->tolerance, "Change of radiance at which a pixel counts as converged")
      ->check(CLI::Range(1e-12, 1.0))
      ->capture_default_str();
  reference_app->add_option("--max-steps", truth->max_steps, "Most steps along a ray")
      ->check(CLI::Range(2, 1 << 20))
      ->capture_default_str();
  reference_app->footer("Example: pellucid reference fog_forest --size 360x270 -o truth.exr");
  commands.push_back({reference_app, [truth] { return reference(*truth); }});
}

}  // namespace pellucid::sandbox
