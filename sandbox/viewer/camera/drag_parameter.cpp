#include "sandbox/viewer/camera/drag_parameter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <variant>

namespace pellucid::sandbox {
namespace {

/// 0, 1, 2 for a name that ends in _x, _y, _z, with or without the unit; -1 for others.
int axis_of(std::string name) {
  if (name.ends_with("_m")) name.resize(name.size() - 2);
  if (name.size() < 3 || name[name.size() - 2] != '_') return -1;
  const char last = name.back();
  return last >= 'x' && last <= 'z' ? last - 'x' : -1;
}

std::string object_of(std::string name) {
  if (name.ends_with("_m")) name.resize(name.size() - 2);
  return name.substr(0, name.size() - 2);
}

double number(const Value& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  if (const auto* real = std::get_if<double>(&value)) return *real;
  return 0;
}

Value clamped(const ParameterInfo& info, double value) {
  const double in_range = std::clamp(value, info.min, info.max);
  if (info.type == ValueType::integer) return static_cast<std::int64_t>(std::llround(in_range));
  return in_range;
}

}  // namespace

std::string first_placement(const std::vector<ParameterInfo>& infos) {
  for (const ParameterInfo& info : infos)
    if (info.type == ValueType::real && axis_of(info.name) >= 0) return info.name;
  return "";
}

std::vector<std::pair<std::string, Value>> dragged(const std::string& name, const std::vector<ParameterInfo>& infos,
                                                   const std::function<Value(const std::string&)>& get,
                                                   const View& view, float dx_px, float dy_px, int width_px,
                                                   int height_px) {
  std::vector<std::pair<std::string, Value>> out;
  if (axis_of(name) < 0) {
    for (const ParameterInfo& info : infos) {
      if (info.name != name || (info.type != ValueType::real && info.type != ValueType::integer)) continue;
      const double by = (info.max - info.min) * static_cast<double>(dx_px) / std::max(1, width_px);
      out.emplace_back(name, clamped(info, number(get(name)) + by));
    }
    return out;
  }
  const glm::vec3 towards = view.target - view.eye;
  const float distance = glm::length(towards);
  const glm::vec3 right = glm::normalize(glm::cross(towards, view.up));
  const glm::vec3 up = glm::normalize(glm::cross(right, towards));
  const float per_pixel =
      2 * distance * std::tan(glm::radians(view.fov_y_deg) / 2) / static_cast<float>(std::max(1, height_px));
  bool has_height = false;
  for (const ParameterInfo& info : infos)
    has_height = has_height || (axis_of(info.name) == 1 && object_of(info.name) == object_of(name));
  // On the floor, up on the screen is away from the eye.
  glm::vec3 away(towards.x, 0, towards.z);
  away = glm::length(away) > 0 ? glm::normalize(away) : up;
  const glm::vec3 by = per_pixel * (dx_px * right - dy_px * (has_height ? up : away));
  for (const ParameterInfo& info : infos) {
    const int axis = axis_of(info.name);
    if (axis < 0 || object_of(info.name) != object_of(name) || info.type != ValueType::real) continue;
    out.emplace_back(info.name, clamped(info, number(get(info.name)) + static_cast<double>(by[axis])));
  }
  return out;
}

}  // namespace pellucid::sandbox
