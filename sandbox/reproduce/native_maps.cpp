#include "sandbox/reproduce/native_maps.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "gl/error.hpp"
#include "plots/pictures/false_color.hpp"

namespace pellucid::sandbox {

using nlohmann::ordered_json;

std::string techniques_with_maps() {
  std::string out;
  for (const TechniqueInfo& info : techniques()) {
    if (info.maps) out += fmt::format("{}{}", out.empty() ? "" : ", ", info.name);
  }
  return out;
}

void check_maps(const TechniqueInfo& technique, const std::filesystem::path& folder) {
  if (!technique.maps) {
    throw InputError(fmt::format("--maps: {} does not tell its errors by pixel; there are maps of {}", technique.name,
                                 techniques_with_maps()));
  }
  std::error_code error;
  if (std::filesystem::exists(folder, error) && !std::filesystem::is_directory(folder, error))
    throw RuntimeError(fmt::format("--maps {}: it is not a folder", folder.string()));
}

ordered_json write_maps(const std::filesystem::path& folder, const std::vector<NativeMap>& maps,
                        const Attributes& attributes) {
  const auto shows = [](const NativeMap& map) {
    return std::any_of(map.values.pixels.begin(), map.values.pixels.end(), [](float v) { return std::isfinite(v); });
  };
  if (std::none_of(maps.begin(), maps.end(), shows))
    throw InputError("--maps: no pixel shows an object whose errors the technique could tell");
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!std::filesystem::is_directory(folder, error))
    throw RuntimeError(fmt::format("--maps {}: cannot make this folder: {}", folder.string(), error.message()));
  ordered_json out = ordered_json::object();
  for (const NativeMap& map : maps) {
    // 0 or 1 needs no scale.
    const double range = map.unit.empty() ? 1 : plots::color_range({&map.values});
    double largest = 0;
    for (const float value : map.values.pixels) {
      if (std::isfinite(value)) largest = std::max(largest, static_cast<double>(value));
    }
    const std::filesystem::path exr = folder / (map.name + ".exr"), png = folder / (map.name + ".png");
    ImageFile file;
    file.image = map.values;
    file.attributes = attributes;
    file.attributes["pellucid.map"] = ordered_json{{"name", map.name}, {"unit", map.unit}, {"doc", map.doc}}.dump();
    write_exr(exr, file, ExrPixel::single);
    write_png(png, plots::false_colors(map.values, range));
    out[map.name] = {{"unit", map.unit}, {"doc", map.doc}, {"width", map.values.width}, {"height", map.values.height},
                     {"range", range},   {"max", largest}, {"exr", exr.string()},       {"png", png.string()}};
  }
  return out;
}

std::string maps_text(const ordered_json& written) {
  std::string out;
  for (const auto& [name, map] : written.items()) {
    const std::string unit = map.at("unit").get<std::string>();
    out +=
        fmt::format("{}: {}{}; black 0 to pale yellow {:.6g}, at most {:.3g}, grey without a value\n",
                    map.at("png").get<std::string>(), map.at("doc").get<std::string>(),
                    unit.empty() ? "" : " [" + unit + "]", map.at("range").get<double>(), map.at("max").get<double>());
  }
  return out;
}

}  // namespace pellucid::sandbox
