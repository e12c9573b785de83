#include "algorithms/reference/interface_bend.hpp"

#include <algorithm>

#include "algorithms/shaders/optics.hpp"

namespace pellucid {
namespace {

// A reflected ray leaves at no less than this sine above the triangle, or than half the sine at which it came.
constexpr double kLowest = 1e-3;
constexpr int kHalvings = 24;

// The normal nearest to the interpolated one, on the arc to the triangle's own, that `sound` accepts; it accepts the
// latter.
template <class F>
glm::dvec3 bent(const glm::dvec3& normal, const glm::dvec3& face, F sound) {
  if (sound(normal)) return normal;
  double bad = 0.0, good = 1.0;
  glm::dvec3 best = face;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (bad + good);
    const glm::dvec3 n = glm::normalize(glm::mix(normal, face, middle));
    if (sound(n)) {
      good = middle;
      best = n;
    } else {
      bad = middle;
    }
  }
  return best;
}

bool reflects_above(const glm::dvec3& direction, const glm::dvec3& n, const glm::dvec3& face) {
  const double lowest = std::min(kLowest, -0.5 * glm::dot(direction, face));
  return glm::dot(direction, n) < 0.0 && glm::dot(reflected(direction, n), face) >= lowest;
}

double incidence_cosine(const glm::dvec3& direction, const glm::dvec3& n) {
  return std::clamp(-glm::dot(direction, n), 0.0, 1.0);
}

}  // namespace

Bend reflect_at(const glm::dvec3& direction, const glm::dvec3& normal, const glm::dvec3& face) {
  Bend bend;
  bend.normal = bent(normal, face, [&](const glm::dvec3& n) { return reflects_above(direction, n, face); });
  bend.cosine = incidence_cosine(direction, bend.normal);
  bend.reflected = glm::normalize(reflected(direction, bend.normal));
  return bend;
}

Split split_at(const glm::dvec3& direction, const glm::dvec3& normal, const glm::dvec3& face, double eta) {
  Split split;
  split.normal = bent(normal, face, [&](const glm::dvec3& n) {
    if (!reflects_above(direction, n, face)) return false;
    const std::optional<glm::dvec3> behind = refracted(direction, n, eta);
    return !behind || glm::dot(*behind, face) < 0.0;
  });
  split.cosine = incidence_cosine(direction, split.normal);
  split.reflected = glm::normalize(reflected(direction, split.normal));
  split.reflected_share = fresnel_dielectric(split.cosine, eta);
  if (split.reflected_share < 1.0) split.refracted = refracted(direction, split.normal, eta);
  if (!split.refracted) split.reflected_share = 1.0;
  return split;
}

}  // namespace pellucid
