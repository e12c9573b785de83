// pellucid render.
#include <cstdio>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "algorithms/render_session.hpp"
#include "algorithms/scene/images/picture_file.hpp"
#include "algorithms/scene/loading_facts.hpp"
#include "gl/context.hpp"
#include "sandbox/commands/commands.hpp"
#include "sandbox/commands/frame_options.hpp"
#include "sandbox/commands/scene_facts.hpp"
#include "sandbox/reproduce/native_maps.hpp"

namespace pellucid::sandbox {
namespace {

using nlohmann::ordered_json;

struct Options : FrameOptions {
  std::string technique;
  std::filesystem::path maps;  // a folder; empty: none
};

int render(const Options& options) {
  const Size size = parse_size(options.size);
  check_output(options.output, {".exr", ".png"});
  const TechniqueInfo& technique = find_technique(options.technique);  // a wrong name is told before the scene loads
  if (!options.maps.empty()) check_maps(technique, options.maps);
  Scene scene = load_scene(options.scene);
  check_output_is_no_input(options.output, scene);
  print_warnings(scene);
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
  const bool half = session.parameters().value("frame.format", "") == "half";
  const std::size_t saturated = half ? saturated_pixels(file.image) : 0;
  if (saturated > 0)
    fmt::print(stderr,
               "warning: {} pixels reach 65504, the most that the frame's 16-bit floats hold (frame.format=single "
               "holds more)\n",
               saturated);

  ordered_json recipe{{"scene", options.scene}, {"technique", options.technique}, {"view", session.camera().view.name},
                      {"width", size.width},    {"height", size.height},          {"parameters", session.parameters()}};
  ordered_json origin = file_provenance();
  origin["scene_hash"] = session.scene().content_hash();
  origin["device"] = context.device().renderer;
  origin["driver"] = context.device().version;
  file.attributes = file_attributes("render", recipe, origin);
  write_picture(options.output, file, options.display);
  ordered_json maps;
  if (!options.maps.empty()) {
    maps =
        write_maps(options.maps, session.technique().native_maps(), file_attributes("render --maps", recipe, origin));
  }

  if (options.json) {
    ordered_json out = recipe;
    // One frame, the first: shaders and caches are cold. Sweeps measure; this only tells that it ran.
    out["first_frame_ms"] = time->frame_ms;
    for (const auto& [pass, ms] : time->pass_ms)
      out["pass_ms"][pass] = ms;
    out["clock"] = gl::name(timer.clock());
    out["prepare_s"] = prepare_s;
    nlohmann::json errors = nlohmann::json::object();
    session.technique().native_errors(errors);
    out["native_errors"] = errors;
    out["saturated_pixels"] = saturated;
    out["gpu_bytes"] = gl::allocated_bytes();
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    out["peak_rss_bytes"] = static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
    out["volume"] = volume_json(session.scene());
    out["warnings"] = loading_facts(session.scene()).warnings;
    out["provenance"] = origin;
    out["output"] = options.output.string();
    if (!options.maps.empty()) out["maps"] = maps;
    fmt::print("{}\n", out.dump(2));
  } else {
    fmt::print(stderr, "{}: {} of {}, {}x{}, first frame {:.1f} ms on {}\n", options.output.string(), options.technique,
               options.scene, size.width, size.height, time->frame_ms, context.device().renderer);
    if (!options.maps.empty()) fmt::print(stderr, "{}", maps_text(maps));
  }
  return kDone;
}

}  // namespace

void add_render(CLI::App& root, std::vector<Command>& commands) {
  auto options = std::make_shared<Options>();
  CLI::App* render_app = root.add_subcommand("render", "Render one frame of a scene with a technique");
  add_frame_options(*render_app, *options);
  render_app->add_option("-t,--technique", options->technique, "A technique (pellucid list techniques)")->required();
  render_app->add_option("--maps", options->maps,
                         fmt::format("Write the technique's own errors by pixel into this folder, NAME.exr with the "
                                     "values and NAME.png in colours: of {}",
                                     techniques_with_maps()));
  render_app->footer(
      "Example: pellucid render fog_forest -t sampling_hulls -s hulls=4 -s samples=8 -o fog.png\n"
      "An EXR carries what made it: pellucid reproduce fog.exr -o DIR renders it again.");
  commands.push_back({render_app, [options] { return render(*options); }});
}

}  // namespace pellucid::sandbox
