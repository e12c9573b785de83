// pellucid bench.
#include "sweeps/bench/bench.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/bare_frame.hpp"
#include "algorithms/scene/files/tell.hpp"
#include "algorithms/scene/images/frame_size.hpp"
#include "algorithms/technique.hpp"
#include "gl/context.hpp"
#include "gl/error.hpp"
#include "sandbox/arguments.hpp"
#include "sandbox/commands/commands.hpp"
#include "sweeps/bench/ceilings.hpp"
#include "sweeps/spec/clock.hpp"
#include "sweeps/spec/provenance.hpp"

namespace pellucid::sandbox {
namespace {

using nlohmann::ordered_json;
using sweeps::BenchRatio;
using sweeps::BenchReference;
using sweeps::BenchResult;
using sweeps::TimingSummary;

struct BenchArguments {
  std::string technique, scene, view, size = "720x540";
  std::vector<std::string> settings;
  int frames = sweeps::BenchRequest{}.frames;
  std::optional<int> device;
  bool vtk = true;
  bool reference = true;
  bool json = false;
};

/// The comparison with VTK, or why there is none.
struct AgainstVtk {
  std::optional<sweeps::BenchVtk> result;
  std::string skipped;
};

AgainstVtk against_vtk(const TechniqueInfo& technique, const BenchArguments& options,
                       const sweeps::BenchRequest& request, gl::Context& context) {
  if (!options.vtk) return {std::nullopt, "not asked for"};
  try {
    return {sweeps::bench_against_vtk(technique, request, context), {}};
  } catch (const RuntimeError& error) {
    context.make_current();
    return {std::nullopt, error.what()};
  }
}

ordered_json time_json(const TimingSummary& t) {
  return {
      {"frame_ms_median", t.median_ms}, {"frame_ms_ci95_low", t.ci95_ms.low}, {"frame_ms_ci95_high", t.ci95_ms.high}};
}

ordered_json ratio_json(const std::optional<BenchRatio>& ratio) {
  if (!ratio) return nullptr;
  return {{"median", ratio->median}, {"ci95_low", ratio->ci95.low}, {"ci95_high", ratio->ci95.high}};
}

void print_time(const char* what, const TimingSummary& t) {
  fmt::print("  {:<34} {:9.3f} ms  [{:.3f}, {:.3f}]\n", what, t.median_ms, t.ci95_ms.low, t.ci95_ms.high);
}

void print_ratio(const char* what, const std::optional<BenchRatio>& ratio) {
  if (ratio) {
    fmt::print("  {:<34} {:9.3f}     [{:.3f}, {:.3f}]\n", what, ratio->median, ratio->ci95.low, ratio->ci95.high);
  } else {
    fmt::print("  {:<34} {:>9}     the shaders take no time that stands out of the noise\n", what, "-");
  }
}

ordered_json vtk_json(const AgainstVtk& against) {
  if (!against.result) return {{"skipped", against.skipped}};
  const sweeps::BenchVtk& r = *against.result;
  return {{"method", time_json(r.method)}, {"vtk", time_json(r.vtk)}, {"ratio", ratio_json(r.ratio)},
          {"method_rmse", r.method_rmse},  {"vtk_rmse", r.vtk_rmse},  {"sample_distance_m", r.sample_distance_m},
          {"equal_error", r.equal()}};
}

void print_vtk(const AgainstVtk& against) {
  if (!against.result) {
    fmt::print("against VTK: skipped, {}\n", against.skipped);
    return;
  }
  const sweeps::BenchVtk& r = *against.result;
  fmt::print("the medium alone, white over black, against VTK's GPU ray casting\n");
  print_time("frame", r.method);
  print_time("VTK's frame", r.vtk);
  print_ratio("frame / VTK's", r.ratio);
  fmt::print("  {:<34} {:9.3g}     root mean square where the volume is seen\n", "error", r.method_rmse);
  fmt::print("  {:<34} {:9.3g}     at a sample distance of {:.3g} m{}\n", "VTK's error", r.vtk_rmse,
             r.sample_distance_m, r.equal() ? "" : ", its least: it does not come down to the frame's");
}

ordered_json reference_json(const std::optional<BenchReference>& reference) {
  if (!reference) return nullptr;
  return {{"trace", time_json(reference->trace)},
          {"build_ms", reference->build_ms},
          {"ratio", ratio_json(reference->ratio)},
          {"rays_per_pixel", reference->rays_per_pixel},
          {"depth", reference->depth},
          {"reflections", reference->reflections}};
}

void print_reference(const BenchReference& reference) {
  print_time("the reference's tracing", reference.trace);
  print_ratio("reference / frame", reference.ratio);
  fmt::print(
      "  {:<34} {:9.3f}     one tree per pixel, up to {} along a path; without building the hierarchy "
      "({:.3g} ms)\n",
      "rays per pixel", reference.rays_per_pixel, counted(static_cast<std::size_t>(reference.depth), "interface"),
      reference.build_ms);
}

ordered_json ceilings_json(const std::vector<sweeps::Ceiling>& ceilings) {
  ordered_json out = ordered_json::array();
  for (const sweeps::Ceiling& c : ceilings)
    out.push_back({{"what", c.what}, {"detail", c.detail}, {"per_second", c.rate}});
  return out;
}

void print_ceilings(const std::vector<sweeps::Ceiling>& ceilings) {
  for (const sweeps::Ceiling& c : ceilings)
    fmt::print("  {:<12} {:<20} {:10.3f} {}\n", c.what, c.detail, c.rate / c.scale, c.unit);
}

/// The device's ceilings, and with `all` every technique that has a bare shader, on its own scene, beside its ceiling.
int bench_summary(const BenchArguments& options, bool all) {
  const FrameSize size = parse_frame_size(options.size, "--size");
  const gl::Context context({.device = options.device});
  const std::vector<sweeps::Ceiling> ceilings = sweeps::measure_ceilings();
  const auto ceiling = [&](std::string_view what) {
    double rate = 0;
    for (const sweeps::Ceiling& c : ceilings) {
      if (c.what == what) rate = std::max(rate, c.rate);
    }
    return rate;
  };
  const double fetch_ceiling = ceiling("fetches");
  const double blend_ceiling = ceiling("blends");
  ordered_json techniques = ordered_json::array();
  if (!options.json) {
    fmt::print("{}\nceilings\n", context.device().renderer);
    print_ceilings(ceilings);
    if (all) {
      fmt::print("techniques at {}\n  {:<20} {:<16} {:>10} {:>24} {:>10} {:>8} {:>10} {:>8}\n", options.size, "",
                 "scene", "frame ms", "frame / bare", "Mfetch/s", "of most", "Mblend/s", "of most");
    }
  }
  for (const BareFrameInfo* bare : bare_frames()) {
    if (!all) break;
    nlohmann::json recipe;
    const sweeps::BenchRequest request{"", options.view, size.width, size.height, {}, options.frames, false};
    const BenchResult r = sweeps::bench(find_technique(bare->technique), request, recipe);
    const double pixels_per_s = static_cast<double>(size.width) * size.height / (r.method.median_ms / 1000);
    const double fetches_per_s = r.fetches_per_pixel * pixels_per_s;
    const double blends_per_s = r.blends_per_pixel * pixels_per_s;
    if (options.json) {
      techniques.push_back({{"technique", bare->technique},
                            {"scene", bare->scene},
                            {"method", time_json(r.method)},
                            {"bare", time_json(r.bare)},
                            {"ratio", ratio_json(r.ratio)},
                            {"ratio_without_opaque", ratio_json(r.own)},
                            {"fetches_per_second", fetches_per_s},
                            {"share_of_fetch_ceiling", fetches_per_s / fetch_ceiling},
                            {"blends_per_second", blends_per_s},
                            {"share_of_blend_ceiling", blends_per_s / blend_ceiling}});
      continue;
    }
    fmt::print("  {:<20} {:<16} {:10.3f} {:>24} {:10.3f} {:6.1f} % {:10.3f} {:6.1f} %\n", bare->technique, bare->scene,
               r.method.median_ms,
               fmt::format("{:.3f} [{:.3f}, {:.3f}]", r.ratio.median, r.ratio.ci95.low, r.ratio.ci95.high),
               fetches_per_s / 1e6, 100 * fetches_per_s / fetch_ceiling, blends_per_s / 1e6,
               100 * blends_per_s / blend_ceiling);
  }
  if (options.json) {
    ordered_json out{{"device", context.device().renderer},
                     {"driver", context.device().version},
                     {"ceilings", ceilings_json(ceilings)}};
    if (all) out["techniques"] = techniques;
    fmt::print("{}\n", out.dump(2));
  } else if (all) {
    fmt::print(
        "\"of most\" is the share of the highest ceiling above, whatever the format; a technique's own ceiling is its "
        "bare shader, which makes the\nsame fetches and blends and nothing else: frame / bare is the distance to it\n");
  }
  return kDone;
}

int bench(const BenchArguments& options) {
  if (options.technique == "ceilings" || options.technique == "all")
    return bench_summary(options, options.technique == "all");
  const FrameSize size = parse_frame_size(options.size, "--size");
  const TechniqueInfo& info = find_technique(options.technique);
  const BareFrameInfo& bare = sweeps::bare_frame_of(info);
  sweeps::BenchRequest request{options.scene,  options.view,     size.width, size.height, {},
                               options.frames, options.reference};
  for (const std::string& setting : options.settings)
    request.settings.push_back(parse_assignment(setting));
  gl::Context context({.device = options.device});
  nlohmann::json recipe;
  const BenchResult result = sweeps::bench(info, request, recipe);
  const bool volume = bare.volume;
  const AgainstVtk vtk = volume ? against_vtk(info, options, request, context)
                                : AgainstVtk{std::nullopt, "it draws volumes, the technique does not"};

  // Without the passes that both share; one view ray each, where the technique casts some.
  const double own_ms = result.method.median_ms - result.opaque.median_ms;
  const std::optional<double> blends_per_s =
      result.own && own_ms > 0
          ? std::optional(result.blends_per_pixel * static_cast<double>(size.width) * size.height * 1e3 / own_ms)
          : std::nullopt;

  if (options.json) {
    ordered_json out = recipe;
    out["frames"] = result.frames;
    out["block_frames"] = BenchResult::kBlockFrames;
    out["method"] = time_json(result.method);
    out["bare"] = time_json(result.bare);
    out["opaque"] = time_json(result.opaque);
    out["ratio"] = ratio_json(result.ratio);
    out["ratio_without_opaque"] = ratio_json(result.own);
    out["blends_per_pixel"] = result.blends_per_pixel;
    out["fetches_per_blend"] = result.fetches_per_blend;
    out["fetches_per_pixel"] = result.fetches_per_pixel;
    out["blends_per_second_without_opaque"] = blends_per_s ? ordered_json(*blends_per_s) : ordered_json(nullptr);
    out["reference"] = reference_json(result.reference);
    out["against_vtk"] = vtk_json(vtk);
    out["device"] = context.device().renderer;
    out["driver"] = context.device().version;
    out["clock"] = result.clock;
    out["commit"] = sweeps::kCommit;
    out["dirty"] = sweeps::kDirty;
    out["started_utc"] = sweeps::utc_text(sweeps::unix_now_s());
    out["argv"] = process_arguments();
    fmt::print("{}\n", out.dump(2));
    return kDone;
  }
  const nlohmann::json& parameters = recipe.at("parameters");
  const std::string counts = bare.counts(parameters);
  fmt::print("{} of {}, view {}, {}, {}x{}; medians of {} frames [95 % interval]\n", options.technique,
             recipe.at("scene").get<std::string>(), recipe.at("view").get<std::string>(), counts, size.width,
             size.height, result.frames);
  print_time("frame", result.method);
  print_time("bare shader's frame", result.bare);
  print_time("passes that both share, alone", result.opaque);
  print_ratio("frame / bare", result.ratio);
  print_ratio("the same without these", result.own);
  fmt::print("  {:<34} {:9.3f}\n", "blends per pixel", result.blends_per_pixel);
  fmt::print("  {:<34} {:9.3f}     {:.4g} per blend\n", "texture fetches per pixel", result.fetches_per_pixel,
             result.fetches_per_blend);
  if (blends_per_s)
    fmt::print("  {:<34} {:9.3f} M   without what both share\n", "blends per second", *blends_per_s / 1e6);
  if (result.reference) print_reference(*result.reference);
  if (volume) print_vtk(vtk);
  fmt::print("on {}, clock {}\n", context.device().renderer, result.clock);
  return kDone;
}

}  // namespace

void add_bench(cli::App& root, std::vector<Command>& commands) {
  auto options = std::make_shared<BenchArguments>();
  std::vector<std::string_view> names;
  for (const BareFrameInfo* info : bare_frames())
    names.push_back(info->technique);
  cli::App* app = root.add_subcommand(
      "bench",
      "Time a technique's frame against a bare shader with the same fetches and blends, and against VTK or "
      "ray tracing");
  app->add_option(
         "technique", options->technique,
         fmt::format("The technique: {}; or `ceilings` for what the device can do at most, or `all` for both on "
                     "one page",
                     fmt::join(names, ", ")))
      ->required();
  app->add_option("--scene", options->scene,
                  "A scene's name (pellucid list scenes) or a .toml file; the technique's own without it");
  app->add_option("-s,--set", options->settings,
                  "name=value of a parameter, scene.name for the scene's own; repeatable")
      ->allow_extra_args(false);
  app->add_option("--view", options->view, "A named view; the first without it");
  app->add_option("--size", options->size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  app->add_option("--frames", options->frames,
                  fmt::format("Frames timed of each, rounded up to whole blocks of {}", BenchResult::kBlockFrames))
      ->check(cli::Range(2 * BenchResult::kBlockFrames, 100000))
      ->capture_default_str();
  app->add_flag("!--no-vtk", options->vtk, "Leave out the comparison with VTK's GPU ray casting");
  app->add_flag("!--no-reference", options->reference, "Leave out the comparison with ray tracing");
  app->add_option("--device", options->device, "EGL device (pellucid devices)");
  app->add_flag("--json", options->json, "Print the measurement as JSON");
  app->footer(
      "Example: pellucid bench TECHNIQUE -s NAME=VALUE --size 512x512\n"
      "Example: pellucid bench all --frames 24\n"
      "Blocks of frames alternate between the technique, the bare shader and the opaque passes that both share. A "
      "ratio\n"
      "is the median over the blocks, so that it may differ a little from that of the medians. Times of different\n"
      "machines or runs do not compare.\n"
      "Against VTK the scene's volume is drawn alone and white over black, and VTK's sample distance is the longest "
      "at\n"
      "which its error against the reference is no larger than the technique's. VTK needs no display for it.\n"
      "Against ray tracing the reference traces the same picture between the blocks, one tree of "
      "rays\n"
      "per pixel on all cores of the processor, following light as far as the frame does.");
  commands.push_back({app, [options] { return bench(*options); }});
}

}  // namespace pellucid::sandbox
