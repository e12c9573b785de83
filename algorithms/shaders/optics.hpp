#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include <glm/glm.hpp>

/// Light at a smooth interface, in double precision. GLSL twin: shaders/optics.glsl.
namespace pellucid {

/// Reflected share of unpolarised light at a dielectric: the mean of the two squared polarised amplitudes (Timonen,
/// Sec. 2; Chan and Wang 2005, Sec. 2). `cosine` ∈ [0, 1] of the angle of incidence, `eta` the index before the
/// interface over the index behind it. 1 beyond the critical angle.
inline double fresnel_dielectric(double cosine, double eta) {
  const double sine2 = eta * eta * (1.0 - cosine * cosine);
  if (sine2 >= 1.0) return 1.0;
  const double behind = std::sqrt(1.0 - sine2);
  // s: (n1 cos θ1 − n2 cos θ2) / (n1 cos θ1 + n2 cos θ2), and p alike; over n2.
  const double s = (eta * cosine - behind) / (eta * cosine + behind);
  const double p = (cosine - eta * behind) / (cosine + eta * behind);
  return 0.5 * (s * s + p * p);
}

/// Reflected share of a metal of index n + ik (Szirmay-Kalos et al. 2005, Sec. 3, after Lazányi):
/// F = ((n−1)² + k² + 4n(1−cos θ)^5) / ((n+1)² + k²), per channel. With k = 0 also their dielectric.
inline glm::dvec3 fresnel_metal(double cosine, const glm::dvec3& n, const glm::dvec3& k) {
  const double grazing = std::pow(1.0 - cosine, 5.0);
  const glm::dvec3 below = (n + 1.0) * (n + 1.0) + k * k;
  return ((n - 1.0) * (n - 1.0) + k * k + 4.0 * n * grazing) / below;
}

/// Direction behind the interface (Snell), unit; nothing beyond the critical angle. `direction` unit, `normal` unit and
/// against it.
inline std::optional<glm::dvec3> refracted(const glm::dvec3& direction, const glm::dvec3& normal, double eta) {
  const double cosine = -glm::dot(direction, normal);
  const double sine2 = eta * eta * (1.0 - cosine * cosine);
  if (sine2 > 1.0) return std::nullopt;
  return glm::normalize(eta * direction + (eta * cosine - std::sqrt(1.0 - sine2)) * normal);
}

inline glm::dvec3 reflected(const glm::dvec3& direction, const glm::dvec3& normal) {
  return direction - 2.0 * glm::dot(direction, normal) * normal;
}

/// The light that absorption leaves over a path [m] (Beer–Lambert).
inline glm::dvec3 transmitted(const glm::dvec3& absorption, double path_m) {
  return glm::exp(-absorption * path_m);
}

}  // namespace pellucid
