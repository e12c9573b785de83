#include "algorithms/raster/native_map.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace pellucid {

NativeMap make_native_map(std::string_view name, std::string_view unit, std::string_view doc, int width, int height) {
  NativeMap map{std::string(name), std::string(unit), std::string(doc), Image(width, height, 1)};
  std::fill(map.values.pixels.begin(), map.values.pixels.end(), std::numeric_limits<float>::quiet_NaN());
  return map;
}

float& gl_pixel(NativeMap& map, std::size_t pixel) {
  const auto width = static_cast<std::size_t>(map.values.width), height = static_cast<std::size_t>(map.values.height);
  assert(pixel < width * height);
  return map.values.pixels[(height - 1 - pixel / width) * width + pixel % width];
}

void summarise(const NativeMap& map, nlohmann::json& out) {
  std::vector<double> values;
  double sum = 0;
  for (const float value : map.values.pixels) {
    if (!std::isfinite(value)) continue;
    values.push_back(static_cast<double>(value));
    sum += values.back();
  }
  if (values.empty()) return;
  const double mean = sum / static_cast<double>(values.size());
  if (map.unit.empty()) {
    out[map.name + "_share"] = mean;
    return;
  }
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  };
  out[map.name + "_mean"] = mean;
  out[map.name + "_median"] = at(0.5);
  out[map.name + "_q95"] = at(0.95);
  out[map.name + "_max"] = values.back();
}

}  // namespace pellucid
