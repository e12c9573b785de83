#include "sweeps/reference_settings.hpp"

#include <array>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

namespace pellucid::sweeps {
namespace {

template <class Choice, std::size_t n>
using Names = std::array<std::pair<Choice, const char*>, n>;

constexpr Names<ReferenceMethod, 2> kMethods{{{ReferenceMethod::exact, "exact"}, {ReferenceMethod::slices, "slices"}}};
constexpr Names<ReferenceSurfaces, 3> kSurfaces{{{ReferenceSurfaces::raster, "raster"},
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

nlohmann::json to_json(const ReferenceSettings& settings) {
  return {
      {"method", name(settings.method)},      {"surfaces", name(settings.surfaces)}, {"tolerance", settings.tolerance},
      {"max_steps", settings.max_steps},      {"slices", settings.slices},           {"format", name(settings.format)},
      {"shadow_share", settings.shadow_share}};
}

ReferenceSettings reference_settings(const nlohmann::json& all) {
  return {.method = find_choice(kMethods, all, "method"),
          .surfaces = find_choice(kSurfaces, all, "surfaces"),
          .tolerance = all.at("tolerance"),
          .max_steps = all.at("max_steps"),
          .slices = all.at("slices"),
          .format = find_choice(kFormats, all, "format"),
          .shadow_share = all.at("shadow_share")};
}

}  // namespace pellucid::sweeps
