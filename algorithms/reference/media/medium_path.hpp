#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/reference/interval.hpp"
#include "algorithms/reference/media/cubic.hpp"
#include "algorithms/scene/scene.hpp"

/// The medium along a ray, exactly. Between eight voxel centres the density is trilinear in the position, so along a
/// ray it is a cubic in the distance; so is the extinction between two points of a piecewise linear transfer function.
/// The optical depth τ is a quartic: no step is needed for it.
namespace pellucid {

/// The part of a ray inside one cell of the grid of voxel centres, and on one piece of the transfer function. Its
/// polynomials are over s in [0, 1] along the span.
struct CellSpan {
  double begin_m = 0;  ///< distance from the ray's origin
  double length_m = 0;
  Cubic extinction{0.0};  ///< σ [1/m]
  Cubic density{0.0};
  Cubic scattering{0.0};  ///< of a volume in a light's space: irradiance over intensity [1/m²]
  std::size_t piece = 0;  ///< of the transfer function

  double sigma(double s) const { return value(extinction, s); }
  /// τ from the span's beginning to s.
  double depth(double s) const {
    return length_m * s * (extinction[0] + s * (extinction[1] / 2 + s * (extinction[2] / 3 + s * extinction[3] / 4)));
  }
};

/// Extinction and albedo of a density: linear functions of it over pieces between two densities.
class TransferFunction {
 public:
  struct Piece {
    double end;                       // the density where the next piece begins
    double extinction, per_density;   // extinction + per_density · density [1/m]
    glm::dvec3 albedo, albedo_slope;  // likewise
  };
  explicit TransferFunction(const Volume&);

  const std::vector<Piece>& pieces() const { return pieces_; }
  glm::dvec3 albedo(std::size_t piece, double density) const {
    return pieces_[piece].albedo + pieces_[piece].albedo_slope * density;
  }
  bool constant_albedo(std::size_t piece) const { return pieces_[piece].albedo_slope == glm::dvec3(0.0); }
  std::size_t piece_of(double density) const;
  /// The parameters in (0, 1) where the density crosses from one piece to another, rising.
  void find_crossings(const Cubic& density, std::vector<double>& crossings) const;

 private:
  std::vector<Piece> pieces_;  // one if there is no transfer function
};

/// The voxels with a border of repeated values, so that clamping at the border needs no case.
class MediumGrid {
 public:
  explicit MediumGrid(const Volume&);

  const TransferFunction& transfer() const { return transfer_; }
  /// Where the ray is inside the box, cut to `limits`.
  Interval clip(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& limits) const;
  /// Calls visit(CellSpan) for the spans of the ray's part `inside` (from clip()), front to back; those without medium
  /// are left out.
  template <class F>
  void trace(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& inside, F visit) const;
  /// τ over that part.
  double optical_depth(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& inside) const;

 private:
  // A ray in a cell: with x = from.x + step.x s, and so on, in units of cells, s in [0, 1].
  struct Crossing {
    double begin_m = 0, end_m = 0;
    std::size_t corner = 0;  // of the cell, in the padded voxels
    glm::dvec3 from{0.0}, step{0.0};
  };
  template <class F>
  void walk(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& inside, F visit) const;
  Cubic along(const std::vector<float>& padded, const Crossing& crossing) const;
  std::vector<float> pad(const std::vector<float>& voxels) const;

  glm::ivec3 size_;           // voxels
  glm::dmat4 to_local_{1.0};  // world → [0,1]³
  std::size_t row_ = 0, slab_ = 0;
  TransferFunction transfer_;
  std::vector<float> density_;     // (size + 2) voxels, x fastest
  std::vector<float> scattering_;  // likewise, or empty
};

// Calls visit(Crossing) for each cell that the ray crosses.
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
      const std::size_t corner = static_cast<std::size_t>(cell.z) * slab_ + static_cast<std::size_t>(cell.y) * row_ +
                                 static_cast<std::size_t>(cell.x);
      visit(Crossing{t, end, corner, o + t * d - glm::dvec3(cell), (end - t) * d});
      t = end;
    }
    if (leave[axis] >= inside.end) break;
    cell[axis] += d[axis] > 0.0 ? 1 : -1;
    // Rounding may place the box's face a hair outside the last cell.
    if (cell[axis] < 0 || cell[axis] > size_[axis]) break;
    find_leave(axis);
  }
}

inline Cubic MediumGrid::along(const std::vector<float>& padded, const Crossing& crossing) const {
  const float* corner = padded.data() + crossing.corner;
  const auto at = [&](std::size_t offset) { return static_cast<double>(corner[offset]); };
  const double v000 = at(0), v100 = at(1), v010 = at(row_), v110 = at(row_ + 1);
  const double v001 = at(slab_), v101 = at(slab_ + 1), v011 = at(slab_ + row_), v111 = at(slab_ + row_ + 1);
  // value = k + kx x + ky y + kz z + kxy xy + kxz xz + kyz yz + kxyz xyz
  const double k = v000, kx = v100 - v000, ky = v010 - v000, kz = v001 - v000;
  const double kxy = v110 - v100 - ky, kxz = v101 - v100 - kz, kyz = v011 - v010 - kz;
  const double kxyz = (v111 - v110) - (v101 - v100) - (v011 - v010) + kz;
  const glm::dvec3 &p = crossing.from, &q = crossing.step;
  const double xy = p.x * p.y, xz = p.x * p.z, yz = p.y * p.z;
  return {k + kx * p.x + ky * p.y + kz * p.z + kxy * xy + kxz * xz + kyz * yz + kxyz * xy * p.z,
          kx * q.x + ky * q.y + kz * q.z + kxy * (p.x * q.y + p.y * q.x) + kxz * (p.x * q.z + p.z * q.x) +
              kyz * (p.y * q.z + p.z * q.y) + kxyz * (xy * q.z + xz * q.y + yz * q.x),
          kxy * q.x * q.y + kxz * q.x * q.z + kyz * q.y * q.z +
              kxyz * (p.x * q.y * q.z + p.y * q.x * q.z + p.z * q.x * q.y),
          kxyz * q.x * q.y * q.z};
}

template <class F>
void MediumGrid::trace(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& inside, F visit) const {
  std::vector<double> cuts;
  const auto emit = [&](CellSpan&& span) {
    // On one piece the extinction is linear in the density.
    const TransferFunction::Piece& piece = transfer_.pieces()[span.piece];
    span.extinction = piece.per_density * span.density;
    span.extinction[0] += piece.extinction;
    if (span.extinction != Cubic(0.0)) visit(span);
  };
  walk(origin, direction, inside, [&](const Crossing& crossing) {
    const double length_m = crossing.end_m - crossing.begin_m;
    const Cubic density = along(density_, crossing);
    const Cubic scattering = scattering_.empty() ? Cubic(0.0) : along(scattering_, crossing);
    cuts.clear();
    if (transfer_.pieces().size() > 1) transfer_.find_crossings(density, cuts);
    double from = 0.0;
    for (std::size_t i = 0; i <= cuts.size(); ++i) {
      const double to = i < cuts.size() ? cuts[i] : 1.0;
      const bool whole = from == 0.0 && to == 1.0;
      emit({crossing.begin_m + from * length_m, (to - from) * length_m, Cubic(0.0),
            whole ? density : stretched(density, from, to), whole ? scattering : stretched(scattering, from, to),
            transfer_.piece_of(value(density, 0.5 * (from + to)))});
      from = to;
    }
  });
}

}  // namespace pellucid
