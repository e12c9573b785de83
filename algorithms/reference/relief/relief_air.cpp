#include "algorithms/reference/relief/relief_air.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pellucid {
namespace {

constexpr int kMostSteps = 100000;
constexpr int kStepsOfChord = 8;

// The squared index at a place, and half its gradient [1/m]; trilinear.
struct Field {
  const ReliefAir& air;
  const ReliefRay& ray;

  double at(const glm::dvec3& p, glm::dvec3& pull) const {
    const glm::dvec2 uv = (ray.uv + glm::dvec2(p) * ray.uv_per_metre) * glm::dvec2(air.size) - 0.5;
    const double top = air.size.z - 1, height = static_cast<double>(air.height_m);
    const double w = std::clamp(p.z / height, 0.0, 1.0) * top;
    const long x = static_cast<long>(std::floor(uv.x)), y = static_cast<long>(std::floor(uv.y));
    const long z = std::min(static_cast<long>(w), static_cast<long>(top) - 1);
    const glm::dvec3 f(uv.x - static_cast<double>(x), uv.y - static_cast<double>(y), w - static_cast<double>(z));
    const auto wrapped = [](long i, int n) { return static_cast<std::size_t>((i % n + n) % n); };
    const std::size_t columns[] = {wrapped(x, air.size.x), wrapped(x + 1, air.size.x)};
    const std::size_t rows[] = {wrapped(y, air.size.y), wrapped(y + 1, air.size.y)};
    double c[2][2][2];
    for (std::size_t k = 0; k < 8; ++k) {
      const std::size_t slice = static_cast<std::size_t>(z) + (k >> 2);
      const std::size_t row = slice * static_cast<std::size_t>(air.size.y) + rows[k >> 1 & 1];
      c[k & 1][k >> 1 & 1][k >> 2] =
          static_cast<double>(air.index2[row * static_cast<std::size_t>(air.size.x) + columns[k & 1]]);
    }
    const auto mix = [](double a, double b, double t) { return a + t * (b - a); };
    const auto face = [&](int axis, int side) {
      const auto corner = [&](int a, int b) {
        return axis == 0 ? c[side][a][b] : axis == 1 ? c[a][side][b] : c[a][b][side];
      };
      const double s = axis == 0 ? f.y : f.x, t = axis == 2 ? f.y : f.z;
      return mix(mix(corner(0, 0), corner(1, 0), s), mix(corner(0, 1), corner(1, 1), s), t);
    };
    const glm::dvec3 scale(ray.uv_per_metre * glm::dvec2(air.size), top / height);
    for (int axis = 0; axis < 3; ++axis)
      pull[axis] = 0.5 * scale[axis] * (face(axis, 1) - face(axis, 0));
    return mix(face(2, 0), face(2, 1), f.z);
  }
};

}  // namespace

BentRay bend_through(const ReliefAir& air, const ReliefRay& ray, double step_m,
                     const std::function<bool(const glm::dvec3& from, const glm::dvec3& to)>& stops) {
  const Field field{air, ray};
  glm::dvec3 p = ray.origin, pull;
  glm::dvec3 momentum = ray.direction * std::sqrt(field.at(p, pull));
  BentRay bent;
  glm::dvec3 asked = p;
  for (int i = 0; i < kMostSteps; ++i) {
    const double h = step_m / glm::length(momentum);
    glm::dvec3 k1, k2, k3, k4;
    field.at(p, k1);
    const glm::dvec3 v2 = momentum + 0.5 * h * k1;
    field.at(p + 0.5 * h * momentum, k2);
    const glm::dvec3 v3 = momentum + 0.5 * h * k2;
    field.at(p + 0.5 * h * v2, k3);
    const glm::dvec3 v4 = momentum + h * k3;
    field.at(p + h * v3, k4);
    const glm::dvec3 before = p, slower = momentum;
    p += h / 6.0 * (momentum + 2.0 * v2 + 2.0 * v3 + v4);
    momentum += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    const bool down = p.z <= 0.0, up = p.z > static_cast<double>(air.height_m) && momentum.z > 0.0;
    if (stops && (down || up || i % kStepsOfChord == kStepsOfChord - 1)) {
      if (stops(asked, p)) {
        bent.end = BentRay::End::stopped;
        return bent;
      }
      asked = p;
    }
    if (down) {
      const double share = before.z / (before.z - p.z);
      bent.end = BentRay::End::comes_down;
      bent.position = glm::mix(before, p, share);
      bent.direction = glm::normalize(glm::mix(slower, momentum, share));
      return bent;
    }
    if (up) break;
  }
  bent.position = p;
  bent.direction = glm::normalize(momentum);
  return bent;
}

}  // namespace pellucid
