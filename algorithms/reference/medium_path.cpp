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

// Calls visit(begin, end, coefficients of the density over s in [0, 1]) for each cell that the ray crosses.
template <class F>
void MediumGrid::walk(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& inside, F visit) const {
  if (!(inside.end > inside.begin)) return;
  // In units of cells of the padded grid, voxel i's centre lies at i + 1.
  const glm::dvec3 voxels(size_);
  const glm::dvec3 o = glm::dvec3(to_local_ * glm::dvec4(origin, 1.0)) * voxels + 0.5;
  const glm::dvec3 d = glm::dvec3(to_local_ * glm::dvec4(direction, 0.0)) * voxels;

  glm::ivec3 cell = glm::clamp(glm::ivec3(glm::floor(o + inside.begin * d)), glm::ivec3(0), size_);
  glm::dvec3 leave(std::numeric_limits<double>::infinity());  // where the ray leaves the cell, along each axis
  const auto find_leave = [&](int axis) {
    if (d[axis] != 0.0) leave[axis] = (cell[axis] + (d[axis] > 0.0 ? 1 : 0) - o[axis]) / d[axis];
  };
  for (int axis = 0; axis < 3; ++axis)
    find_leave(axis);

  double t = inside.begin;
  while (t < inside.end) {
    const int axis = leave.x < leave.y ? (leave.x < leave.z ? 0 : 2) : (leave.y < leave.z ? 1 : 2);
    const double end = std::min(leave[axis], inside.end);
    if (end > t) {
      const float* corner = padded_.data() + static_cast<std::size_t>(cell.z) * slab_ +
                            static_cast<std::size_t>(cell.y) * row_ + static_cast<std::size_t>(cell.x);
      const auto at = [&](std::size_t offset) { return static_cast<double>(corner[offset]); };
      const double v000 = at(0), v100 = at(1), v010 = at(row_), v110 = at(row_ + 1);
      const double v001 = at(slab_), v101 = at(slab_ + 1), v011 = at(slab_ + row_), v111 = at(slab_ + row_ + 1);
      // density = k + kx x + ky y + kz z + kxy xy + kxz xz + kyz yz + kxyz xyz
      const double k = v000, kx = v100 - v000, ky = v010 - v000, kz = v001 - v000;
      const double kxy = v110 - v100 - ky, kxz = v101 - v100 - kz, kyz = v011 - v010 - kz;
      const double kxyz = (v111 - v110) - (v101 - v100) - (v011 - v010) + kz;
      // With x = p.x + q.x s, and so on.
      const glm::dvec3 p = o + t * d - glm::dvec3(cell), q = (end - t) * d;
      const double xy = p.x * p.y, xz = p.x * p.z, yz = p.y * p.z;
      visit(t, end,
            glm::dvec4(k + kx * p.x + ky * p.y + kz * p.z + kxy * xy + kxz * xz + kyz * yz + kxyz * xy * p.z,
                       kx * q.x + ky * q.y + kz * q.z + kxy * (p.x * q.y + p.y * q.x) + kxz * (p.x * q.z + p.z * q.x) +
                           kyz * (p.y * q.z + p.z * q.y) + kxyz * (xy * q.z + xz * q.y + yz * q.x),
                       kxy * q.x * q.y + kxz * q.x * q.z + kyz * q.y * q.z +
                           kxyz * (p.x * q.y * q.z + p.y * q.x * q.z + p.z * q.x * q.y),
                       kxyz * q.x * q.y * q.z));
      t = end;
    }
    if (leave[axis] >= inside.end) break;
    cell[axis] += d[axis] > 0.0 ? 1 : -1;
    // Rounding may place the box's face a hair outside the last cell.
    if (cell[axis] < 0 || cell[axis] > size_[axis]) break;
    find_leave(axis);
  }
}

void MediumGrid::trace(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& inside,
                       std::vector<CellSpan>& spans) const {
  walk(origin, direction, inside, [&](double begin, double end, const glm::dvec4& density) {
    if (density != glm::dvec4(0.0)) spans.push_back({begin, end - begin, extinction_ * density});
  });
}

double MediumGrid::optical_depth(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& inside) const {
  double depth = 0.0;
  walk(origin, direction, inside, [&](double begin, double end, const glm::dvec4& density) {
    depth += CellSpan{begin, end - begin, density}.depth(1.0);
  });
  return extinction_ * depth;
}

}  // namespace pellucid
