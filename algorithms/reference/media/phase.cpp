#include "algorithms/reference/media/phase.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pellucid {

glm::dvec3 deflected(const glm::dvec3& direction, double anisotropy, Random& random) {
  const double u = static_cast<double>(random.next()), g = anisotropy;
  double cosine = 1 - 2 * u;
  if (std::abs(g) > 1e-4) {
    const double s = (1 - g * g) / (1 + g - 2 * g * u);
    cosine = std::clamp((1 + g * g - s * s) / (2 * g), -1.0, 1.0);
  }
  return direction_about(direction, cosine, static_cast<double>(random.next()));
}

glm::dvec3 direction_about(const glm::dvec3& axis, double cosine, double turn) {
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine)), angle = 2 * std::numbers::pi * turn;
  const glm::dvec3 side =
      glm::normalize(glm::cross(axis, std::abs(axis.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
  return glm::normalize(cosine * axis + sine * (std::cos(angle) * side + std::sin(angle) * glm::cross(axis, side)));
}

}  // namespace pellucid
