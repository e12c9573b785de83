#include "algorithms/reference/relief/relief_air.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pellucid {
namespace {

constexpr int kMostSteps = 100000;

// The squared index at a place, and half its gradient [1/m]; trilinear.
struct Field {
  const ReliefAir& air;
  const ReliefRay& ray;

  double texel(long x, long y, long z) const {
    const auto wrapped = [](long i, int n) { return static_cast<std::size_t>((i % n + n) % n); };
    const std::size_t slice =
        static_cast<std::size_t>(z) * static_cast<std::size_t>(air.size.y) + wrapped(y, air.size.y);
    return static_cast<double>(air.index2[slice * static_cast<std::size_t>(air.size.x) + wrapped(x, air.size.x)]);
  }
  double at(const glm::dvec3& p, glm::dvec3& pull) const {
    const glm::dvec2 uv = (ray.uv + glm::dvec2(p) * ray.uv_per_metre) * glm::dvec2(air.size) - 0.5;
    const double top = air.size.z - 1, height = static_cast<double>(air.height_m);
    const double w = std::clamp(p.z / height, 0.0, 1.0) * top;
    const long x = static_cast<long>(std::floor(uv.x)), y = static_cast<long>(std::floor(uv.y));
    const long z = std::min(static_cast<long>(w), static_cast<long>(top) - 1);
    const glm::dvec3 f(uv.x - static_cast<double>(x), uv.y - static_cast<double>(y), w - static_cast<double>(z));
    double c[2][2][2];
    for (int k = 0; k < 8; ++k)
      c[k & 1][k >> 1 & 1][k >> 2] = texel(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2));
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

BentRay bend_through(const ReliefAir& air, const ReliefRay& ray, double step_m) {
  const Field field{air, ray};
  glm::dvec3 p = ray.origin, pull;
  glm::dvec3 momentum = ray.direction * std::sqrt(field.at(p, pull));
  BentRay bent;
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
    if (p.z <= 0.0) {
      const double share = before.z / (before.z - p.z);
      bent.meets = true;
      bent.position = glm::mix(before, p, share);
      bent.direction = glm::normalize(glm::mix(slower, momentum, share));
      return bent;
    }
    if (p.z > static_cast<double>(air.height_m) && momentum.z > 0.0) break;
  }
  bent.position = p;
  bent.direction = glm::normalize(momentum);
  return bent;
}

}  // namespace pellucid
