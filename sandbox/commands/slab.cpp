// pellucid slab.
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/scattering/transfer_fit.hpp"
#include "sandbox/commands/commands.hpp"

namespace pellucid::sandbox {
namespace {

using nlohmann::ordered_json;
using namespace scattering;

struct SlabArguments {
  double depth = 1;
  SlabMedium medium;
  std::string model = "gaussian";
  bool json = false;
};

double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

TransferModel parse_model(const std::string& name) {
  return name == "gaussian"      ? TransferModel::gaussian
         : name == "unscattered" ? TransferModel::unscattered
                                 : TransferModel::two_gaussians;
}

ordered_json curve_json(const SlabLight& light, const std::vector<double>& radiance) {
  ordered_json out = ordered_json::array();
  for (std::size_t i = 0; i < radiance.size(); ++i)
    out.push_back({{"angle_deg", degrees(std::acos(light.cosine[i]))}, {"radiance", radiance[i]}});
  return out;
}

int slab(const SlabArguments& options) {
  check_depth(options.depth, "slab");
  const SlabLight light = Slab(options.medium).light(options.depth);
  const TransferFit fit = fit_transfer(light, parse_model(options.model));
  if (options.json) {
    ordered_json out{{"depth", options.depth},
                     {"anisotropy", options.medium.anisotropy},
                     {"albedo", options.medium.albedo},
                     {"model", options.model},
                     {"reflectance", light.reflectance},
                     {"transmittance", light.transmittance},
                     {"unscattered", light.unscattered},
                     {"sharp", fit.sharp},
                     {"f_t", fit.f_t},
                     {"c_t", fit.c_t},
                     {"theta_bar_deg", degrees(fit.theta_bar)},
                     {"f_2", fit.f_2},
                     {"theta_2_deg", degrees(fit.theta_2)},
                     {"c_r", fit.c_r},
                     {"fit_rms", fit.rms},
                     {"transmission", curve_json(light, light.transmission)},
                     {"reflection", curve_json(light, light.reflection)}};
    fmt::print("{}\n", out.dump(2));
    return kDone;
  }
  fmt::print("reflectance    {:.6f}\ntransmittance  {:.6f}\nunscattered    {:.6f}\n", light.reflectance,
             light.transmittance, light.unscattered);
  fmt::print("fit            f_t {:.4f}, theta_bar {:.3f} deg", fit.f_t, degrees(fit.theta_bar));
  if (options.model == "two_gaussians") fmt::print(", f_2 {:.4f}, theta_2 {:.3f} deg", fit.f_2, degrees(fit.theta_2));
  if (options.model == "unscattered") fmt::print(", sharp {:.4f}", fit.sharp);
  fmt::print(", c_t {:.4f}, c_r {:.4f}; rms {:.4f}\n", fit.c_t, fit.c_r, fit.rms);
  fmt::print("angle [deg]  transmission [1/sr]  reflection [1/sr]\n");
  for (std::size_t i = 0; i < light.cosine.size(); ++i)
    fmt::print("{:11.3f}  {:19.6f}  {:17.6f}\n", degrees(std::acos(light.cosine[i])), light.transmission[i],
               light.reflection[i]);
  return kDone;
}

}  // namespace

void add_slab(cli::App& root, std::vector<Command>& commands) {
  auto options = std::make_shared<SlabArguments>();
  cli::App* app = root.add_subcommand("slab", "Compute how a scattering slab spreads a beam");
  app->add_option("--depth", options->depth, "Optical thickness: extinction times thickness")->required();
  app->add_option("--anisotropy", options->medium.anisotropy,
                  "Mean cosine of the scattering angle (Henyey and Greenstein's phase function), above -1 and below 1")
      ->required();
  app->add_option("--albedo", options->medium.albedo, "Share of the extinction that is scattering, from 0 to 1")
      ->required();
  app->add_option(
         "--model", options->model,
         fmt::format("The functions that the transmission is fitted by: {} (default: gaussian)", kTransferModels))
      ->check(cli::IsMember({"gaussian", "unscattered", "two_gaussians"}));
  app->add_flag("--json", options->json, "Print JSON");
  app->footer(
      "The beam is perpendicular and has unit flux, and the slab has no interface. Radiance is that of scattered\n"
      "light; transmittance holds the unscattered part too. The fit is of light seen through the slab: its parts\n"
      "sharp, f_t, f_2 and c_t sum to the transmittance. theta_bar is a Gaussian's standard deviation in the angle,\n"
      "c_t and c_r are spread over the sphere, and fit_rms compares the light within each angle, as a share of the\n"
      "incident flux.\n"
      "Example: pellucid slab --depth 2 --anisotropy 0.75 --albedo 0.9 --json");
  commands.push_back({app, [options] { return slab(*options); }});
}

}  // namespace pellucid::sandbox
