#include "algorithms/key_maps/sphere_map.hpp"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

#include "gl/cube_faces.hpp"
#include "gl/error.hpp"

namespace pellucid::scattering {
namespace {

using std::numbers::pi;
constexpr double kRinging = 0.05;  // of the mean: what a negative pixel may hold

}  // namespace

void check_environment(const Environment& environment) {
  if (!environment.image) return;
  const Image& image = *environment.image;
  if (image.width != 2 * image.height)
    throw InputError(
        fmt::format("environment: the image of {}x{} pixels is not twice as wide as high, so that it is no "
                    "latitude-longitude map",
                    image.width, image.height));
  const auto visit = [&](auto&& each) {
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        for (int c = 0; c < std::min(image.channels, 3); ++c)
          each(x, y, image.at(x, y)[c]);
      }
    }
  };
  double sum = 0;
  const auto fail = [](int x, int y, float v) {
    throw InputError(fmt::format("environment: pixel ({}, {}) of the image holds {}, which is no radiance", x, y, v));
  };
  visit([&](int x, int y, float v) {
    if (!std::isfinite(v)) fail(x, y, v);
    sum += static_cast<double>(v);
  });
  // Maps that were converted from another colour space or scaled dip a little below 0.
  const double mean = sum / (static_cast<double>(image.width) * image.height * std::min(image.channels, 3));
  const auto lowest = static_cast<float>(-kRinging * std::max(mean, 0.0));
  visit([&](int x, int y, float v) {
    if (v < lowest) fail(x, y, v);
  });
}

SphereMap::SphereMap(int width, int height)
    : width_(width), height_(height), rgb_(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
  for (int y = 0; y < height; ++y) {
    sines_.push_back(std::sin(polar(y)));
    areas_.push_back(2 * pi / width * (std::cos(pi * y / height) - std::cos(pi * (y + 1) / height)));
  }
  for (int x = 0; x < width; ++x) {
    const double azimuth = 2 * pi * (x + 0.5) / width - pi;
    column_cosines_.push_back(std::cos(azimuth));
    column_sines_.push_back(std::sin(azimuth));
  }
}

SphereMap::SphereMap(const Image& image) : SphereMap(image.width, image.height) {
  float* out = rgb_.data();
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const float* in = image.at(x, y);
      for (int c = 0; c < 3; ++c)
        *out++ = in[image.channels >= 3 ? c : 0];
    }
  }
}

SphereMap::SphereMap(const Environment& environment, int height) : SphereMap(2 * height, height) {
  Environment unscaled = environment;
  unscaled.scale = 1;
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x)
      set(x, y, glm::dvec3(unscaled.radiance(glm::vec3(direction(x, y)))));
  }
}

glm::dvec3 SphereMap::direction(int x, int y) const {
  return {sine(y) * column_sine(x), std::cos(polar(y)), -sine(y) * column_cosine(x)};
}

void SphereMap::set(int x, int y, const glm::dvec3& radiance) {
  float* texel = rgb_.data() + index(x, y);
  for (int c = 0; c < 3; ++c)
    texel[c] = static_cast<float>(radiance[c]);
}

glm::dvec3 SphereMap::across_poles(int x, int y) const {
  y = (y % (2 * height_) + 2 * height_) % (2 * height_);
  if (y >= height_) {
    y = 2 * height_ - 1 - y;
    x += width_ / 2;
  }
  const float* texel = rgb_.data() + index((x % width_ + width_) % width_, y);
  return {static_cast<double>(texel[0]), static_cast<double>(texel[1]), static_cast<double>(texel[2])};
}

glm::dvec3 SphereMap::at(const glm::dvec3& direction) const {
  const double u = 0.5 + std::atan2(direction.x, -direction.z) / (2 * pi);
  const double v = std::acos(std::clamp(direction.y, -1.0, 1.0)) / pi;
  const double px = u * width_ - 0.5, py = v * height_ - 0.5;
  const int x = static_cast<int>(std::floor(px)), y = static_cast<int>(std::floor(py));
  return glm::mix(glm::mix(across_poles(x, y), across_poles(x + 1, y), px - x),
                  glm::mix(across_poles(x, y + 1), across_poles(x + 1, y + 1), px - x), py - y);
}

glm::dvec3 SphereMap::mean() const {
  glm::dvec3 sum(0.0);
  for (int y = 0; y < height_; ++y) {
    glm::dvec3 row(0.0);
    for (int x = 0; x < width_; ++x)
      row += across_poles(x, y);
    sum += area(y) * row;
  }
  return sum / (4 * pi);
}

SphereMap SphereMap::halved() const {
  assert(width_ % 2 == 0 && height_ % 2 == 0);
  SphereMap out(width_ / 2, height_ / 2);
  for (int y = 0; y < out.height_; ++y) {
    const double a = area(2 * y), b = area(2 * y + 1);
    for (int x = 0; x < out.width_; ++x) {
      out.set(x, y,
              (a * (across_poles(2 * x, 2 * y) + across_poles(2 * x + 1, 2 * y)) +
               b * (across_poles(2 * x, 2 * y + 1) + across_poles(2 * x + 1, 2 * y + 1))) /
                  (2 * (a + b)));
    }
  }
  return out;
}

SphereMap SphereMap::resampled(int height) const {
  SphereMap out(2 * height, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < out.width_; ++x)
      out.set(x, y, at(out.direction(x, y)));
  }
  return out;
}

glm::dvec3 texel_direction(int size, int face, int x, int y) {
  return glm::normalize(gl::cube_direction({face, (x + 0.5) / size, (y + 0.5) / size}));
}

double texel_area(int size, int x, int y) {
  const auto corner = [&](int i, int j) {
    const double s = 2.0 * i / size - 1, t = 2.0 * j / size - 1;
    return std::atan2(s * t, std::sqrt(s * s + t * t + 1));
  };
  return corner(x + 1, y + 1) - corner(x, y + 1) - corner(x + 1, y) + corner(x, y);
}

}  // namespace pellucid::scattering
