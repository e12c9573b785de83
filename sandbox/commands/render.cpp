// pellucid render.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "algorithms/render_session.hpp"
#include "algorithms/scene/files/tell.hpp"
#include "algorithms/scene/images/finite.hpp"
#include "algorithms/scene/images/frame_size.hpp"
#include "algorithms/scene/images/picture_file.hpp"
#include "algorithms/scene/loading_facts.hpp"
#include "gl/context.hpp"
#include "sandbox/commands/commands.hpp"
#include "sandbox/commands/frame_options.hpp"
#include "sandbox/commands/scene_facts.hpp"
#include "sandbox/file_provenance.hpp"
#include "sandbox/reproduce/native_maps.hpp"
#include "sandbox/viewer/camera/frame_range.hpp"
#include "sandbox/viewer/out/tev_client.hpp"

namespace pellucid::sandbox {
namespace {

using nlohmann::ordered_json;

struct RenderArguments : FrameOptions {
  std::string technique;
  std::filesystem::path maps;  // a folder; empty: none
  std::string frames, tev;     // "0:120"; "HOST:PORT"
  std::vector<std::string> through;
  double fps = 30;
};

struct Drawn {
  ordered_json json;
  double frame_ms = 0;
  ordered_json maps;
};

/// One frame into one file.
Drawn draw(const RenderArguments& options, RenderSession& session, const gl::Context& context, double prepare_s,
           const std::filesystem::path& output, TevClient* tev) {
  gl::PassTimer timer(gl::Detail::passes);
  session.render(timer);
  const auto time = timer.wait();
  ImageFile file;
  file.image = session.read_color();
  require_finite(file.image, fmt::format("the frame of {}", session.technique_info().name));
  const bool half = session.parameters().value("frame.format", "") == "half";
  const std::size_t saturated = half ? saturated_pixels(file.image) : 0;
  if (saturated > 0)
    tell(
        "warning: {} pixels reach 65504, the most that the frame's 16-bit floats hold (frame.format=single "
        "holds more)",
        saturated);

  ordered_json recipe{
      {"scene", options.scene},          {"technique", options.technique},    {"view", session.camera().view.name},
      {"width", session.camera().width}, {"height", session.camera().height}, {"parameters", session.parameters()}};
  ordered_json origin = file_provenance();
  origin["scene_hash"] = session.scene().content_hash();
  origin["device"] = context.device().renderer;
  origin["driver"] = context.device().version;
  file.attributes = file_attributes("render", recipe, origin);
  write_picture(output, file, options.display);
  if (tev != nullptr) tev->send(options.technique + " of " + options.scene, file.image);
  Drawn drawn{.json = recipe, .frame_ms = time->frame_ms, .maps = {}};
  if (!options.maps.empty()) {
    drawn.maps =
        write_maps(options.maps, session.technique().native_maps(), file_attributes("render --maps", recipe, origin));
  }
  ordered_json& out = drawn.json;
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
  out["output"] = output.string();
  if (!options.maps.empty()) out["maps"] = drawn.maps;
  return drawn;
}

/// Moves the session to a frame of the range: its time, its place on the camera's way.
void go_to_frame(const RenderArguments& options, RenderSession& session, const FrameRange& range, int frame) {
  const auto infos = session.scene().parameters().infos();
  const bool timed = std::any_of(infos.begin(), infos.end(), [](const auto& info) { return info.name == "time_s"; });
  if (timed) {
    session.assign("scene.time_s", frame / options.fps);
  } else if (options.through.empty()) {
    throw InputError(fmt::format("--frames: scene {} has no parameter time_s, and without --through nothing moves",
                                 session.scene().name));
  }
  std::vector<std::string> views{options.view};
  views.insert(views.end(), options.through.begin(), options.through.end());
  session.set_view(frame_view(session.scene(), views, range, frame));
}

int render(const RenderArguments& options) {
  const FrameSize size = parse_frame_size(options.size, "--size");
  check_output(options.output, {".exr", ".png"});
  const bool many = !options.frames.empty();
  const FrameRange range = many ? parse_frames(options.frames) : FrameRange{};
  if (many) numbered(options.output.string(), range.first);  // a wrong name is told before the work
  if (many && !options.maps.empty()) throw InputError("--maps goes with one frame, not with --frames");
  if (!many && !options.through.empty()) throw InputError("--through goes with --frames");
  const TechniqueInfo& technique = find_technique(options.technique);  // a wrong name is told before the scene loads
  if (!options.maps.empty()) check_maps(technique, options.maps);
  std::optional<TevClient> tev;
  if (!options.tev.empty()) tev.emplace(options.tev);
  Scene scene = load_scene(options.scene);
  check_output_is_no_input(options.output, scene);
  print_warnings(scene);
  const gl::Context context({.device = options.device});
  RenderSession session(std::move(scene), options.technique, options.view, size.width, size.height);
  for (const std::string& setting : options.settings) {
    const auto [name, value] = parse_assignment(setting);
    session.assign_text(name, value);
  }
  ordered_json all = ordered_json::array();
  for (int frame = range.first; frame <= range.last; ++frame) {
    if (many) go_to_frame(options, session, range, frame);
    const double prepare_s = session.prepare();
    const std::filesystem::path output = many ? numbered(options.output.string(), frame) : options.output;
    const Drawn drawn = draw(options, session, context, prepare_s, output, tev ? &*tev : nullptr);
    if (options.json) {
      all.push_back(drawn.json);
    } else {
      tell("{}: {} of {}, {}x{}, first frame {:.1f} ms on {}", output.string(), options.technique, options.scene,
           size.width, size.height, drawn.frame_ms, context.device().renderer);
      if (!options.maps.empty()) fmt::print(stderr, "{}", maps_text(drawn.maps));
    }
  }
  if (options.json) fmt::print("{}\n", (many ? all : all.front()).dump(2));
  return kDone;
}

}  // namespace

void add_render(cli::App& root, std::vector<Command>& commands) {
  auto options = std::make_shared<RenderArguments>();
  cli::App* render_app = root.add_subcommand("render", "Render one frame of a scene with a technique");
  add_frame_options(*render_app, *options);
  render_app->add_option("-t,--technique", options->technique, "A technique (pellucid list techniques)")->required();
  render_app->add_option("--maps", options->maps,
                         fmt::format("Write the technique's own errors by pixel into this folder, NAME.exr with the "
                                     "values and NAME.png in colours: of {}",
                                     techniques_with_maps()));
  render_app->add_option("--frames", options->frames,
                         "FIRST:LAST, both drawn: scene.time_s is frame / fps; -o has the number as %04d");
  render_app->add_option("--fps", options->fps, "Frames of --frames in a second")
      ->check(cli::Range(0.001, 100000.0))
      ->capture_default_str();
  render_app
      ->add_option("--through", options->through,
                   "A view that the camera goes through from --view on, over --frames; repeatable")
      ->allow_extra_args(false);
  render_app->add_option("--tev", options->tev, "HOST:PORT of a tev or HDRView window that shows the picture too");
  render_app->footer(
      "Example: pellucid render fog_forest -t volume_slices -s slices=64 -o fog.png\n"
      "         pellucid render spheres_hall -t environment_map --frames 0:120 --fps 30 -o hall.%04d.exr\n"
      "An EXR carries what made it: pellucid reproduce fog.exr -o DIR renders it again.");
  commands.push_back({render_app, [options] { return render(*options); }});
}

}  // namespace pellucid::sandbox
