#include "sweeps/spec/reference_settings.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"

namespace pellucid::sweeps {
namespace {

template <class Choice, std::size_t n>
using Names = std::array<std::pair<Choice, const char*>, n>;

constexpr Names<ReferenceMethod, 2> kMethods{{{ReferenceMethod::exact, "exact"}, {ReferenceMethod::slices, "slices"}}};
constexpr Names<ReferenceSurfaces, 4> kSurfaces{{{ReferenceSurfaces::automatic, "automatic"},
                                                 {ReferenceSurfaces::raster, "raster"},
                                                 {ReferenceSurfaces::forward, "forward"},
                                                 {ReferenceSurfaces::rays, "rays"}}};
constexpr Names<SlicesFormat, 2> kFormats{{{SlicesFormat::half, "half"}, {SlicesFormat::single, "single"}}};

template <class Choice, std::size_t n>
const char* find_name(const Names<Choice, n>& names, Choice choice) {
  for (const auto& [value, text] : names) {
    if (value == choice) return text;
  }
  return "";
}

template <class Choice, std::size_t n>
Choice find_choice(const Names<Choice, n>& names, const nlohmann::json& all, const char* field) {
  const std::string& text = all.at(field).get_ref<const std::string&>();
  for (const auto& [value, known] : names) {
    if (known == text) return value;
  }
  static_cast<void>(all.at("no such " + text));  // throws, naming it
  return names.front().first;
}

}  // namespace

const char* name(ReferenceMethod method) {
  return find_name(kMethods, method);
}
const char* name(ReferenceSurfaces surfaces) {
  return find_name(kSurfaces, surfaces);
}
const char* name(SlicesFormat format) {
  return find_name(kFormats, format);
}

ReferenceSettings settled(ReferenceSettings settings, const std::string& scene, bool has_interfaces, bool has_volume) {
  const bool drawn = settings.surfaces == ReferenceSurfaces::raster || settings.surfaces == ReferenceSurfaces::forward;
  if (has_interfaces) {
    if (has_volume) {
      throw InputError(fmt::format(
          "scene '{}' has a volume, and mirrors, metals or dielectrics: there is no reference of a medium behind them",
          scene));
    }
    if (drawn || settings.method == ReferenceMethod::slices) {
      throw InputError(
          fmt::format("scene '{}' has mirrors, metals or dielectrics, which {} does not draw: take surfaces \"rays\"",
                      scene, drawn ? "the forward pass" : "the method \"slices\""));
    }
    settings.surfaces = ReferenceSurfaces::rays;
  }
  if (settings.samples > 1) {
    if (has_volume) {
      throw InputError(
          fmt::format("{} samples a pixel: the medium of scene '{}' is integrated through its centre alone",
                      settings.samples, scene));
    }
    if (drawn) {
      throw InputError(
          fmt::format("{} samples a pixel: the forward pass has one; take surfaces \"rays\"", settings.samples));
    }
    settings.surfaces = ReferenceSurfaces::rays;
  }
  if (settings.caustics) {
    if (drawn) throw InputError("caustics are of surfaces from rays; the forward pass has none");
    settings.surfaces = ReferenceSurfaces::rays;
  }
  if (settings.surfaces == ReferenceSurfaces::automatic) settings.surfaces = ReferenceSurfaces::raster;
  return settings;
}

SurfaceOptions surface_options(const ReferenceSettings& settings) {
  SurfaceOptions options;
  options.samples = settings.samples;
  options.reflections = settings.reflections;
  options.cut = settings.cut;
  options.caustics = settings.caustics;
  options.refract_light = settings.refract_light;
  options.photons = static_cast<std::uint64_t>(settings.photons);
  return options;
}

nlohmann::json to_json(const ReferenceSettings& settings) {
  nlohmann::json all{{"method", name(settings.method)},
                     {"surfaces", name(settings.surfaces)},
                     {"tolerance", settings.tolerance},
                     {"max_steps", settings.max_steps},
                     {"slices", settings.slices},
                     {"format", name(settings.format)},
                     {"shadow_share", settings.shadow_share},
                     {"samples", settings.samples},
                     {"reflections", settings.reflections},
                     {"cut", settings.cut},
                     {"caustics", settings.caustics},
                     {"photons", settings.photons}};
  // Points that were measured before there was this setting keep their text.
  if (settings.refract_light) all["refract_light"] = true;
  return all;
}

ReferenceSettings reference_settings(const nlohmann::json& all) {
  return {.method = find_choice(kMethods, all, "method"),
          .surfaces = find_choice(kSurfaces, all, "surfaces"),
          .tolerance = all.at("tolerance"),
          .max_steps = all.at("max_steps"),
          .slices = all.at("slices"),
          .format = find_choice(kFormats, all, "format"),
          .shadow_share = all.at("shadow_share"),
          .samples = all.at("samples"),
          .reflections = all.at("reflections"),
          .cut = all.at("cut"),
          .caustics = all.at("caustics"),
          .refract_light = all.value("refract_light", false),
          .photons = all.at("photons")};
}

}  // namespace pellucid::sweeps
