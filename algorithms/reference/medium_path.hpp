#pragma once

#include <cstddef>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/scene/scene.hpp"

/// The medium's extinction along a ray, exactly. Between eight voxel centres the density is trilinear in the position,
/// so along a ray it is a cubic in the distance, and the optical depth τ a quartic: no step is needed for it.
namespace pellucid {

/// The part of a ray inside one cell of the grid of voxel centres.
struct CellSpan {
  double begin_m = 0;  ///< distance from the ray's origin
  double length_m = 0;
  glm::dvec4 extinction{0.0};  ///< σ(s) = Σ extinction[i] sⁱ [1/m], s in [0, 1] along the span

  double sigma(double s) const { return extinction[0] + s * (extinction[1] + s * (extinction[2] + s * extinction[3])); }
  /// τ from the span's beginning to s.
  double depth(double s) const {
    return length_m * s * (extinction[0] + s * (extinction[1] / 2 + s * (extinction[2] / 3 + s * extinction[3] / 4)));
  }
};

/// Part of a ray, as distances from its origin; empty when end ≤ begin.
struct Interval {
  double begin = 0;
  double end = 0;
};

/// The voxels with a border of repeated values, so that clamping at the border needs no case.
class MediumGrid {
 public:
  explicit MediumGrid(const Volume&);

  /// Where the ray is inside the box, cut to `limits`.
  Interval clip(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& limits) const;
  /// Calls visit(CellSpan) for the spans of the ray's part `inside` (from clip()), front to back; those without medium
  /// are left out.
  template <class F>
  void trace(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& inside, F visit) const {
    walk(origin, direction, inside, [&](double begin, double end, const glm::dvec4& density) {
      if (density != glm::dvec4(0.0)) visit(CellSpan{begin, end - begin, extinction_ * density});
    });
  }
  /// τ over that part.
  double optical_depth(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& inside) const;

 private:
  // Calls visit(begin, end, coefficients of the density over s in [0, 1]) for each cell that the ray crosses.
  template <class F>
  void walk(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& inside, F visit) const;

  glm::ivec3 size_;            // voxels
  glm::dmat4 to_local_{1.0};   // world → [0,1]³
  double extinction_ = 0;      // φ
  std::vector<float> padded_;  // (size + 2) voxels, x fastest
  std::size_t row_ = 0, slab_ = 0;
};

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

}  // namespace pellucid
