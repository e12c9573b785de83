#include "algorithms/scene/motion.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

#include <glm/gtc/matrix_transform.hpp>

namespace pellucid {

namespace {

glm::dvec3 slope(const Keyframe& a, const Keyframe& b) {
  return (b.value - a.value) / (b.time_s - a.time_s);
}

}  // namespace

glm::dvec3 MotionPath::at(double time_s) const {
  assert(keyframes.size() >= 2);
  const double begin = keyframes.front().time_s;
  const double end = keyframes.back().time_s;
  if (loop) {
    const double period = end - begin;
    time_s = begin + (time_s - begin) - period * std::floor((time_s - begin) / period);
  }
  if (time_s <= begin) return keyframes.front().value;
  if (time_s >= end) return keyframes.back().value;
  const auto later = std::upper_bound(keyframes.begin(), keyframes.end(), time_s,
                                      [](double t, const Keyframe& k) { return t < k.time_s; });
  const std::size_t i = static_cast<std::size_t>(later - keyframes.begin()) - 1;
  const Keyframe& k0 = keyframes[i];
  const Keyframe& k1 = keyframes[i + 1];
  const double span = k1.time_s - k0.time_s;
  const double u = (time_s - k0.time_s) / span;
  if (interpolation == Interpolation::linear) return glm::mix(k0.value, k1.value, u);

  const auto tangent = [&](std::size_t k) {
    const std::size_t last = keyframes.size() - 1;
    if (k > 0 && k < last) return slope(keyframes[k - 1], keyframes[k + 1]);
    if (!loop) return k == 0 ? slope(keyframes[0], keyframes[1]) : slope(keyframes[last - 1], keyframes[last]);
    // The ends of a loop are one point: its neighbours are the second and the last but one.
    const double across = (keyframes[1].time_s - begin) + (end - keyframes[last - 1].time_s);
    return (keyframes[1].value - keyframes[last - 1].value) / across;
  };
  const double u2 = u * u;
  const double u3 = u2 * u;
  return (2 * u3 - 3 * u2 + 1) * k0.value + (u3 - 2 * u2 + u) * span * tangent(i) + (3 * u2 - 2 * u3) * k1.value +
         (u3 - u2) * span * tangent(i + 1);
}

glm::dmat3 rotation(const glm::dvec3& axis, double angle_deg) {
  return glm::dmat3(glm::rotate(glm::dmat4(1.0), glm::radians(angle_deg), glm::normalize(axis)));
}

glm::dmat3 Spin::at(double time_s) const {
  return rotation(axis, std::fmod(deg_per_s * time_s, 360.0));
}

}  // namespace pellucid
