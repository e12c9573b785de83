#include <cassert>
#include <cmath>
#include <cstddef>

#include "algorithms/scene/shapes/procedural.hpp"

namespace pellucid {
namespace {

// Where a direction lies: ρ = sin θ from the y axis, and the cosine and sine of the angle φ about it.
struct Bearing {
  double rho, cosine, sine;
  double cos_lobes, sin_lobes;  // of k·φ
};

Bearing bearing(const StarOptions& options, const glm::dvec3& u) {
  const double rho = std::hypot(u.x, u.z);
  if (rho == 0) return {0, 1, 0, 1, 0};
  const double angle = options.lobes * std::atan2(u.z, u.x);
  return {rho, u.x / rho, u.z / rho, std::cos(angle), std::sin(angle)};
}

}  // namespace

double star_radius(const StarOptions& options, const glm::dvec3& direction) {
  const Bearing b = bearing(options, direction);
  const double amplitude = static_cast<double>(options.amplitude);
  return static_cast<double>(options.radius) * (1 + amplitude * b.rho * b.rho * b.cos_lobes);
}

glm::dvec3 star_normal(const StarOptions& options, const glm::dvec3& direction) {
  // The gradient of |p| − r(θ, φ): r̂ − (∂r/∂θ)/r θ̂ − (∂r/∂φ)/(r sin θ) φ̂.
  const Bearing b = bearing(options, direction);
  const double amplitude = static_cast<double>(options.radius) * static_cast<double>(options.amplitude);
  const double r = star_radius(options, direction);
  const glm::dvec3 along_theta(direction.y * b.cosine, -b.rho, direction.y * b.sine);
  const glm::dvec3 along_phi(-b.sine, 0, b.cosine);
  const double by_theta = 2 * amplitude * b.rho * direction.y * b.cos_lobes / r;
  const double by_phi = -amplitude * options.lobes * b.rho * b.sin_lobes / r;
  return glm::normalize(direction - by_theta * along_theta - by_phi * along_phi);
}

Mesh make_star(const StarOptions& options, int segments) {
  assert(options.radius > 0 && options.lobes >= 1 && options.amplitude >= 0 && options.amplitude < 1);
  // A unit sphere's positions are its directions; equal ones stay equal, so that it stays closed.
  Mesh mesh = make_sphere(1.0F, segments);
  mesh.name = "star";
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::dvec3 u = glm::normalize(glm::dvec3(mesh.positions[i]));
    mesh.positions[i] = glm::vec3(star_radius(options, u) * u);
    mesh.normals[i] = glm::vec3(star_normal(options, u));
  }
  return mesh;
}

}  // namespace pellucid
