#include "algorithms/scene/scene.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "gl/error.hpp"

namespace pellucid {

const View& Scene::find_view(std::string_view wanted) const {
  if (views.empty()) throw InputError(fmt::format("scene '{}' has no views", name));
  if (wanted.empty()) return views.front();
  const auto it = std::find_if(views.begin(), views.end(), [&](const View& v) { return v.name == wanted; });
  if (it != views.end()) return *it;
  std::vector<std::string> names;
  for (const View& view : views)
    names.push_back(view.name);
  const std::string near = nearest_name(wanted, names);
  throw InputError(fmt::format(
      "unknown view '{}' of scene '{}'; {}", wanted, name,
      near.empty() ? fmt::format("it has {}", fmt::join(names, ", ")) : fmt::format("did you mean '{}'?", near)));
}

glm::vec3 Volume::voxel_spacing_m() const {
  const glm::vec3 edges{glm::length(glm::vec3(to_world[0])), glm::length(glm::vec3(to_world[1])),
                        glm::length(glm::vec3(to_world[2]))};
  return edges / glm::vec3(size);
}

glm::vec3 Environment::radiance(const glm::vec3& direction) const {
  if (!image) {
    // Linear in the height of the direction, from the horizon up and down.
    const float y = std::clamp(direction.y, -1.0F, 1.0F);
    return scale * glm::mix(horizon, y >= 0 ? zenith : ground, std::abs(y));
  }
  const float u = 0.5F + std::atan2(direction.x, -direction.z) / (2.0F * std::numbers::pi_v<float>);
  const float v = std::acos(std::clamp(direction.y, -1.0F, 1.0F)) / std::numbers::pi_v<float>;
  const int w = image->width;
  const int h = image->height;
  // Bilinear between pixel centres; u wraps, v ends at the poles.
  const float x = u * static_cast<float>(w) - 0.5F;
  const float y = std::clamp(v * static_cast<float>(h) - 0.5F, 0.0F, static_cast<float>(h - 1));
  const float x_floor = std::floor(x);
  const int x0 = (static_cast<int>(x_floor) % w + w) % w;
  const int x1 = (x0 + 1) % w;
  const int y0 = static_cast<int>(y);
  const int y1 = std::min(y0 + 1, h - 1);
  const auto texel = [&](int column, int row) {
    const float* p = image->at(column, row);
    return image->channels >= 3 ? glm::vec3(p[0], p[1], p[2]) : glm::vec3(p[0]);
  };
  const float fx = x - x_floor;
  const float fy = y - static_cast<float>(y0);
  return scale * glm::mix(glm::mix(texel(x0, y0), texel(x1, y0), fx), glm::mix(texel(x0, y1), texel(x1, y1), fx), fy);
}

namespace {

/// The view's right, up and backward axes (the columns of view_to_world), in double precision.
glm::dmat3 view_axes(const View& view) {
  const glm::dvec3 backward = glm::normalize(glm::dvec3(view.eye) - glm::dvec3(view.target));
  const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(view.up), backward));
  return {right, glm::cross(backward, right), backward};
}

double half_height(const View& view) {
  return std::tan(glm::radians(static_cast<double>(view.fov_y_deg)) / 2);
}

}  // namespace

glm::mat4 Camera::world_to_view() const {
  const glm::dmat3 to_view = glm::transpose(view_axes(view));
  glm::dmat4 result(to_view);
  result[3] = glm::dvec4(-(to_view * glm::dvec3(view.eye)), 1.0);
  return glm::mat4(result);
}

glm::mat4 Camera::projection() const {
  assert(width > 0 && height > 0);
  const double aspect = static_cast<double>(width) / height;
  return glm::mat4(glm::perspective(glm::radians(static_cast<double>(view.fov_y_deg)), aspect,
                                    static_cast<double>(view.near_m), static_cast<double>(view.far_m)));
}

glm::dvec3 Camera::ray_direction(double x, double y) const {
  const double tan_y = half_height(view);
  const double tan_x = tan_y * width / height;
  const glm::dvec3 in_view{(2 * x / width - 1) * tan_x, (1 - 2 * y / height) * tan_y, -1.0};
  return glm::normalize(view_axes(view) * in_view);
}

}  // namespace pellucid
