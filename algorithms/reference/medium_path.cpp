#include "algorithms/reference/medium_path.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>

namespace pellucid {

MediumGrid::MediumGrid(const Volume& volume)
    : size_(volume.size),
      to_local_(glm::inverse(glm::dmat4(volume.to_world))),
      extinction_(static_cast<double>(volume.extinction)),
      row_(static_cast<std::size_t>(volume.size.x) + 2),
      slab_(row_ * (static_cast<std::size_t>(volume.size.y) + 2)) {
  const auto width = static_cast<std::size_t>(size_.x), height = static_cast<std::size_t>(size_.y);
  assert(volume.density.size() == width * height * static_cast<std::size_t>(size_.z));
  padded_.resize(slab_ * (static_cast<std::size_t>(size_.z) + 2));
  float* to = padded_.data();
  for (int z = -1; z <= size_.z; ++z) {
    for (int y = -1; y <= size_.y; ++y) {
      const auto from_y = static_cast<std::size_t>(std::clamp(y, 0, size_.y - 1));
      const auto from_z = static_cast<std::size_t>(std::clamp(z, 0, size_.z - 1));
      const float* from = volume.density.data() + (from_z * height + from_y) * width;
      *to++ = from[0];
      to = std::copy(from, from + width, to);
      *to++ = from[width - 1];
    }
  }
}

Interval MediumGrid::clip(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& limits) const {
  const glm::dvec3 o(to_local_ * glm::dvec4(origin, 1.0)), d(to_local_ * glm::dvec4(direction, 0.0));
  Interval inside = limits;
  for (int axis = 0; axis < 3; ++axis) {
    if (d[axis] == 0.0) {
      if (o[axis] < 0.0 || o[axis] > 1.0) return {0.0, 0.0};
      continue;
    }
    const double a = -o[axis] / d[axis], b = (1.0 - o[axis]) / d[axis];
    inside.begin = std::max(inside.begin, std::min(a, b));
    inside.end = std::min(inside.end, std::max(a, b));
  }
  return inside;
}

double MediumGrid::optical_depth(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& inside) const {
  double depth = 0.0;
  walk(origin, direction, inside, [&](double begin, double end, const glm::dvec4& density) {
    depth += CellSpan{begin, end - begin, density}.depth(1.0);
  });
  return extinction_ * depth;
}

}  // namespace pellucid
