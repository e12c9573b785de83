#include "algorithms/scene/view_text.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <vector>

#include <fmt/format.h>

#include "gl/error.hpp"

namespace pellucid {
namespace {

std::vector<std::string_view> split(std::string_view text, char by) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = text.find(by);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

[[noreturn]] void refuse(std::string_view part, std::string_view why) {
  throw InputError(fmt::format("view: '{}' {}", part, why));
}

float number(std::string_view text, std::string_view part) {
  float value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value) || std::abs(value) > 1e6F)
    refuse(part, "is not a number in [-1e6, 1e6]");
  return value;
}

float number_in(std::string_view text, std::string_view part, float min, float max) {
  const float value = number(text, part);
  if (!(value >= min && value <= max)) refuse(part, fmt::format("is out of range [{}, {}]", min, max));
  return value;
}

glm::vec3 triple(std::string_view text, std::string_view part) {
  const std::vector<std::string_view> parts = split(text, ',');
  if (parts.size() != 3) refuse(part, "is not three numbers, for example eye=0,1.5,4");
  return {number(parts[0], part), number(parts[1], part), number(parts[2], part)};
}

std::string triple_text(const glm::vec3& v) {
  return fmt::format("{},{},{}", v.x, v.y, v.z);
}

}  // namespace

bool is_view_text(std::string_view text) {
  return text.find('=') != std::string_view::npos;
}

View parse_view_text(std::string_view text, const Scene& scene) {
  std::vector<std::string_view> parts = split(text, ':');
  const bool based = parts.front().find('=') == std::string_view::npos;
  View view = scene.find_view(based ? parts.front() : std::string_view{});
  if (based) parts.erase(parts.begin());
  for (const std::string_view part : parts) {
    const std::size_t equals = part.find('=');
    const std::string_view key = part.substr(0, equals);
    const std::string_view value = equals == std::string_view::npos ? std::string_view{} : part.substr(equals + 1);
    if (key == "eye") {
      view.eye = triple(value, part);
    } else if (key == "target") {
      view.target = triple(value, part);
    } else if (key == "up") {
      view.up = triple(value, part);
    } else if (key == "fov") {
      view.fov_y_deg = number_in(value, part, 1, 179);
    } else if (key == "near") {
      view.near_m = number_in(value, part, 1e-4F, 1e6F);
    } else if (key == "far") {
      view.far_m = number_in(value, part, 1e-4F, 1e6F);
    } else {
      static const std::array<std::string, 6> known = {"eye", "target", "up", "fov", "near", "far"};
      const std::string near = nearest_name(key, known);
      refuse(part, near.empty() ? fmt::format("is none of {}", fmt::join(known, "=, ")) + "="
                                : fmt::format("is unknown; did you mean '{}='?", near));
    }
  }
  const glm::vec3 forward = view.target - view.eye;
  if (!(glm::length(forward) > 0)) refuse(text, "has its target at its eye");
  if (!(glm::length(glm::cross(forward / glm::length(forward), view.up)) > 1e-6F * glm::length(view.up)))
    refuse(text, "looks along its up direction");
  if (!(view.near_m < view.far_m)) refuse(text, "has its near plane behind its far plane");
  view.name = text;
  return view;
}

View view_of(const Scene& scene, std::string_view name_or_text) {
  return is_view_text(name_or_text) ? parse_view_text(name_or_text, scene) : scene.find_view(name_or_text);
}

std::string to_view_text(const View& view) {
  return fmt::format("eye={}:target={}:up={}:fov={}:near={}:far={}", triple_text(view.eye), triple_text(view.target),
                     triple_text(view.up), view.fov_y_deg, view.near_m, view.far_m);
}

}  // namespace pellucid
