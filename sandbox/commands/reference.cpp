// pellucid reference.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "algorithms/parameter_names.hpp"
#include "algorithms/raster/shadow_maps.hpp"
#include "algorithms/render_session.hpp"
#include "algorithms/scene/files/tell.hpp"
#include "algorithms/scene/images/finite.hpp"
#include "algorithms/scene/images/frame_size.hpp"
#include "algorithms/scene/loading_facts.hpp"
#include "algorithms/scene/view_text.hpp"
#include "gl/context.hpp"
#include "sandbox/commands/commands.hpp"
#include "sandbox/commands/frame_options.hpp"
#include "sandbox/commands/scene_facts.hpp"
#include "sandbox/file_provenance.hpp"
#include "sandbox/viewer/out/tev_client.hpp"
#include "sweeps/measure/reference_methods.hpp"
#include "sweeps/metrics/metrics.hpp"
#include "sweeps/spec/point_json.hpp"

namespace pellucid::sandbox {
namespace {

using nlohmann::ordered_json;

struct ReferenceArguments : FrameOptions {
  std::string surfaces = "rays", method = "exact", format = "half";
  double tolerance = ReferenceOptions{}.tolerance;
  int max_steps = ReferenceOptions{}.max_steps;
  int slices = sweeps::ReferenceSettings{}.slices;
  double shadow_share = 0;
  SurfaceOptions tracing;
  std::string tev;  // HOST:PORT
};

sweeps::ReferenceSettings reference_settings(const ReferenceArguments& options) {
  sweeps::ReferenceSettings settings;
  settings.method = options.method == "exact" ? sweeps::ReferenceMethod::exact : sweeps::ReferenceMethod::slices;
  settings.surfaces = options.surfaces == "rays"     ? sweeps::ReferenceSurfaces::rays
                      : options.surfaces == "raster" ? sweeps::ReferenceSurfaces::raster
                                                     : sweeps::ReferenceSurfaces::forward;
  settings.format = options.format == "half" ? sweeps::SlicesFormat::half : sweeps::SlicesFormat::single;
  settings.tolerance = options.tolerance;
  settings.max_steps = options.max_steps;
  settings.slices = options.slices;
  settings.shadow_share = options.shadow_share;
  settings.samples = options.tracing.samples;
  settings.caustics = options.tracing.caustics;
  settings.refract_light = options.tracing.refract_light;
  return settings;
}

/// The `-s` of a reference: the scene's parameters, and the shadow maps' where something is drawn with them.
std::map<std::string, Value> reference_parameters(const ReferenceArguments& options, Scene& scene, bool draws) {
  std::map<std::string, Value> out;
  const auto parse = [&](const std::string& full, const std::string& bare, const std::string& text,
                         const std::string& owner, std::span<const ParameterInfo> infos) {
    const auto info = std::find_if(infos.begin(), infos.end(), [&](const ParameterInfo& i) { return i.name == bare; });
    if (info == infos.end()) throw unknown_parameter(bare, owner, infos);
    out[full] = parse_value(*info, text, owner);
  };
  for (const std::string& setting : options.settings) {
    const auto [name, value] = parse_assignment(setting);
    const ParameterName routed = route(name);
    if (routed.owner == ParameterOwner::scene) {
      parse(name, routed.local, value, "scene " + scene.name, scene.parameters().infos());
      scene.parameters().assign(routed.local, out[name], "scene " + scene.name);
    } else if (draws && routed.owner == ParameterOwner::shadow) {
      parse(name, routed.local, value, "shadow", parameter_table<ShadowSettings>().infos());
    } else {
      throw InputError(fmt::format("-s {}: a reference has no technique, so only scene. parameters can be set{}",
                                   setting,
                                   draws ? ", and those of the shadow maps (shadow.) that it is drawn with" : ""));
    }
  }
  for (const ParameterInfo& info : scene.parameters().infos())
    out[full_name(ParameterOwner::scene, info.name)] = scene.parameters().get(info.name);
  return out;
}

/// How far the picture of slices lies from the exact reference.
ordered_json distance(const Image& exact, const Image& slices) {
  sweeps::ComparisonOptions comparing;
  comparing.metrics = sweeps::MetricSet(std::vector<std::string>{"flip", "rmse"});
  const sweeps::ComparisonResult result = sweeps::Comparison(exact, nullptr, std::move(comparing)).compare(slices);
  return {{"to_exact_flip_mean", result.at("flip_mean")}, {"to_exact_rmse", result.at("rmse")}};
}

/// The cost of surfaces from rays, and their errors.
ordered_json statistics_json(const SurfaceStatistics& s) {
  return {{"kept_samples", s.kept_samples},
          {"standard_error_max", s.standard_error_max},
          {"standard_error_mean", s.standard_error_mean},
          {"caustic_standard_error_max", s.caustic_standard_error_max},
          {"caustic_standard_error_mean", s.caustic_standard_error_mean},
          {"cut_weight_max", s.cut_weight_max},
          {"cut_weight_mean", s.cut_weight_mean},
          {"limited_weight_mean", s.limited_weight_mean},
          {"lost_weight_mean", s.lost_weight_mean},
          {"rays", s.rays},
          {"rays_per_s", s.rays_per_s()},
          {"build_s", s.build_s},
          {"photons_s", s.photons_s},
          {"trace_s", s.trace_s}};
}

/// One run of the command, from the scene to the picture and what is said of it.
class ReferenceRun {
 public:
  explicit ReferenceRun(const ReferenceArguments& options)
      : options_(options),
        size_(parse_frame_size(options.size, "--size")),
        settings_(reference_settings(options)),
        scene_(load_scene(options.scene)),
        origin_(file_provenance()) {
    check_output_is_no_input(options.output, scene_);
    print_warnings(scene_);
    settings_ = sweeps::settled(settings_, scene_.name, has_interfaces(scene_), scene_.volume.has_value());
    of_slices_ = settings_.method == sweeps::ReferenceMethod::slices;
    from_rays_ = settings_.surfaces == sweeps::ReferenceSurfaces::rays;
    const bool draws = of_slices_ || settings_.surfaces == sweeps::ReferenceSurfaces::forward;
    parameters_ = reference_parameters(options, scene_, draws);
    camera_ = {view_of(scene_, options.view), size_.width, size_.height};
    tracing_.tolerance = options.tolerance;
    tracing_.max_steps = options.max_steps;
    if (terminal_) {
      tracing_.progress = [](double share) { fmt::print(stderr, "\rreference {:3.0f} %", 100 * share); };
    }
    origin_["scene_hash"] = scene_.content_hash();
    draws_ = draws || settings_.surfaces == sweeps::ReferenceSurfaces::raster;
  }

  void trace() {
    const SurfaceLayer surfaces = draws_ ? drawn_surfaces() : traced_surfaces();
    exact_ = render_reference(scene(), camera_, surfaces, tracing_);
    errors_ = {{"step_error_max", exact_.step_error_max},
               {"step_error_mean", exact_.step_error_mean},
               {"unconverged_share", exact_.unconverged_share}};
    if (from_rays_) errors_.update(statistics_json(exact_.surfaces));
    file_.image = exact_.image;
    file_.layers["mask"] = exact_.mask;
    if (of_slices_) {
      errors_.update(distance(exact_.image, slices_));
      file_.image = std::move(slices_);
    }
    if (settings_.shadow_share > 0) {
      const Reference unshadowed =
          sweeps::trace_unshadowed(sweeps::load_again(options_.scene, parameters_), camera_, surfaces, tracing_);
      file_.layers["shadow"] = sweeps::shadow_mask(exact_.image, unshadowed.image, settings_.shadow_share);
    }
    if (terminal_) fmt::print(stderr, "\r");
    require_finite(file_.image, "reference");
  }

  void write() {
    file_.attributes = file_attributes("reference", recipe(), origin_);
    file_.attributes["pellucid.reference_error"] = errors_.dump();
    write_picture(options_.output, file_, options_.display);
    constexpr double kAtEdges = 1e-6;  // what rounding at sharp edges may lose
    if (from_rays_ && exact_.surfaces.lost_weight_mean > kAtEdges) {
      tell(
          "warning: rays leave a dielectric unmet, or without having entered it ({:.2g} of the light): its mesh is "
          "open or inside out",
          exact_.surfaces.lost_weight_mean);
    }
  }

  const Image& picture() const { return file_.image; }

  void print_json() {
    ordered_json out = recipe();
    out.update(errors_);
    out["volume"] = volume_json(scene());
    out["warnings"] = loading_facts(scene()).warnings;
    out["output"] = options_.output.string();
    fmt::print("{}\n", out.dump(2));
  }

  void print_summary() const {
    const std::string output = options_.output.string();
    tell("{}: {} of {}, {}x{}, step error max {:.2g}, mean {:.2g}; {:.3g} % of the pixels above the tolerance", output,
         of_slices_ ? fmt::format("{} slices in a frame of {} format", options_.slices, options_.format) : "reference",
         options_.scene, size_.width, size_.height, exact_.step_error_max, exact_.step_error_mean,
         100 * exact_.unconverged_share);
    if (from_rays_) {
      const SurfaceStatistics& s = exact_.surfaces;
      tell(
          "{}: {:.3g} s for {} rays ({:.3g} a second); standard error max {:.2g}, mean {:.2g}; weight left out max "
          "{:.2g}, mean {:.2g}",
          output, s.trace_s, s.rays, s.rays_per_s(), s.standard_error_max + s.caustic_standard_error_max,
          s.standard_error_mean + s.caustic_standard_error_mean, s.cut_weight_max, s.cut_weight_mean);
      if (s.kept_samples > 0)
        tell("{}: {} of {} samples a pixel come from an earlier run", output, s.kept_samples, s.samples);
    }
    if (of_slices_) {
      tell("{}: from the exact reference: FLIP {:.4g} in the mean, RMSE {:.4g}", output,
           errors_.at("to_exact_flip_mean").get<double>(), errors_.at("to_exact_rmse").get<double>());
    }
  }

 private:
  /// The session takes the scene, with its parameters as they are; from then on it is used there.
  SurfaceLayer drawn_surfaces() {
    context_.emplace(gl::ContextOptions{.device = options_.device});
    session_.emplace(std::move(scene_), techniques().front().name, camera_.view.name, size_.width, size_.height);
    for (const auto& [name, value] : parameters_) {
      if (route(name).owner == ParameterOwner::shadow) session_->assign(name, value);
    }
    SurfaceLayer surfaces = sweeps::reference_surfaces(*session_, settings_);
    if (of_slices_) {
      slices_ =
          sweeps::draw_slices(options_.scene, parameters_, camera_.view.name, size_.width, size_.height, settings_);
    }
    origin_["device"] = context_->device().renderer;
    origin_["driver"] = context_->device().version;
    return surfaces;
  }

  SurfaceLayer traced_surfaces() const {
    SurfaceOptions rays = options_.tracing;
    rays.progress = tracing_.progress;
    return trace_surfaces(scene_, camera_, rays);
  }

  Scene& scene() { return session_ ? session_->scene() : scene_; }

  ordered_json recipe() const {
    nlohmann::json shown = nlohmann::json::object();
    for (const auto& [name, value] : parameters_)
      shown[name] = sweeps::value_to_json(value);
    ordered_json recipe{{"scene", options_.scene},
                        {"view", camera_.view.name},
                        {"width", size_.width},
                        {"height", size_.height},
                        {"surfaces", options_.surfaces},
                        {"tolerance", options_.tolerance},
                        {"max_steps", options_.max_steps},
                        {"parameters", shown}};
    if (from_rays_) {
      const SurfaceOptions& rays = options_.tracing;
      recipe["samples"] = rays.samples;
      recipe["reflections"] = rays.reflections;
      recipe["cut"] = rays.cut;
      recipe["caustics"] = rays.caustics;
      if (rays.refract_light) recipe["refract_light"] = true;
      if (rays.caustics) {
        recipe["photons"] = rays.photons;
        recipe["caustic_radius_m"] = rays.caustic_radius_m;
      }
    }
    if (of_slices_) {
      recipe["method"] = options_.method;
      recipe["slices"] = options_.slices;
      recipe["format"] = options_.format;
    }
    if (settings_.shadow_share > 0) recipe["shadow_share"] = settings_.shadow_share;
    return recipe;
  }

  const ReferenceArguments& options_;
  const FrameSize size_;
  sweeps::ReferenceSettings settings_;
  Scene scene_;
  ordered_json origin_;  ///< where the file comes from
  const bool terminal_ = isatty(STDERR_FILENO) != 0;
  bool of_slices_ = false, from_rays_ = false, draws_ = false;
  std::map<std::string, Value> parameters_;
  Camera camera_;
  ReferenceOptions tracing_;
  std::optional<gl::Context> context_;
  std::optional<RenderSession> session_;
  Image slices_;
  Reference exact_;
  ordered_json errors_;
  ImageFile file_;
};

int reference(const ReferenceArguments& options) {
  check_output(options.output, {".exr", ".png"});
  std::optional<TevClient> tev;
  if (!options.tev.empty()) tev.emplace(options.tev);  // before the work
  ReferenceRun run(options);
  run.trace();
  run.write();
  if (tev) tev->send("reference of " + options.scene, run.picture());
  if (options.json)
    run.print_json();
  else
    run.print_summary();
  return kDone;
}

void add_rays(cli::App& app, SurfaceOptions& rays) {
  app.add_option("--samples", rays.samples,
                 "Rays per pixel, stratified over its square; 1 is its centre. The standard error is stated")
      ->check(cli::Range(1, 65536))
      ->capture_default_str();
  app.add_option("--reflections", rays.reflections,
                 "Most reflections inside a dielectric; light that needs more is dark")
      ->check(cli::Range(0, 1024))
      ->capture_default_str();
  app.add_option("--cut", rays.cut, "Share of a pixel's light below which a branch at an interface is left out")
      ->check(cli::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_flag("--caustics", rays.caustics, "Light that reaches surfaces through objects, by photons");
  app.add_flag("--refract-light", rays.refract_light,
               "Bend the lights' rays at the media of reliefs, which Timonen leaves straight");
  app.add_option("--photons", rays.photons,
                 "Photons with --caustics, for each light that casts shadows and each object")
      ->check(cli::Range(std::uint64_t{1024}, std::uint64_t{1} << 28))
      ->capture_default_str();
  app.add_option("--caustic-radius", rays.caustic_radius_m,
                 "Radius [m] over which a photon's light is spread; 0: 1 % of the largest object's")
      ->check(cli::Range(0.0, 1e6))
      ->capture_default_str();
}

}  // namespace

void add_reference(cli::App& root, std::vector<Command>& commands) {
  auto options = std::make_shared<ReferenceArguments>();
  cli::App* app = root.add_subcommand("reference", "Compute the ground truth of a scene on the CPU");
  add_frame_options(*app, *options);
  app->add_option(
         "--surfaces", options->surfaces,
         "rays: surfaces traced with Embree; raster: from the forward pass, so that silhouettes are the same as in a "
         "rendering, with exact shadows; forward: with its shadow maps too, so that a metric sees the medium alone")
      ->check(cli::IsMember({"rays", "raster", "forward"}))
      ->capture_default_str();
  add_rays(*app, options->tracing);
  app->add_option("--tolerance", options->tolerance, "Change of radiance at which a pixel counts as converged")
      ->check(cli::Range(1e-12, 1.0))
      ->capture_default_str();
  app->add_option("--max-steps", options->max_steps, "Most steps along a ray")
      ->check(cli::Range(2, 1 << 20))
      ->capture_default_str();
  app->add_option("--method", options->method,
                  "exact: the medium is integrated; slices: the picture of very many slices that Imagire et al. "
                  "2007 judge by, with its distance from the exact one")
      ->check(cli::IsMember({"exact", "slices"}))
      ->capture_default_str();
  const cli::Option* slices = app->add_option("--slices", options->slices, "Slices with --method slices")
                                  ->check(cli::Range(1, 4096))
                                  ->capture_default_str();
  const cli::Option* format = app->add_option("--format", options->format, "half or single: what the slices blend into")
                                  ->check(cli::IsMember({"half", "single"}))
                                  ->capture_default_str();
  app->add_option("--shadow-share", options->shadow_share,
                  "Add a layer `shadow`: the pixels whose luminance the shadows in the medium lower by more than this "
                  "share")
      ->check(cli::Range(0.0, 0.99));
  app->add_option("--tev", options->tev, "HOST:PORT of a tev or HDRView window that shows the picture too");
  app->footer(
      "Examples:\n"
      "  pellucid reference fog_forest --size 360x270 -o truth.exr\n"
      "  pellucid reference fog_forest --method slices --slices 1024 -o slices.exr\n"
      "  pellucid reference teapot_room --surfaces raster --shadow-share 0.05 -o truth.exr\n"
      "  pellucid compare truth.exr hulls.exr --mask shadow");
  commands.push_back({app, [options, slices, format] {
                        for (const cli::Option* option : {slices, format}) {
                          if (option->count() > 0 && options->method != "slices") {
                            throw InputError(fmt::format("{} goes with --method slices", option->get_name()));
                          }
                        }
                        return reference(*options);
                      }});
}

}  // namespace pellucid::sandbox
