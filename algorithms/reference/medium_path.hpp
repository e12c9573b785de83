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
  /// Appends the spans of the ray's part `inside` (from clip()) to `spans`, front to back; those without medium are
  /// left out.
  void trace(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& inside,
             std::vector<CellSpan>& spans) const;
  /// τ over that part.
  double optical_depth(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& inside) const;

 private:
  template <class F>
  void walk(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& inside, F visit) const;

  glm::ivec3 size_;            // voxels
  glm::dmat4 to_local_{1.0};   // world → [0,1]³
  double extinction_ = 0;      // φ
  std::vector<float> padded_;  // (size + 2) voxels, x fastest
  std::size_t row_ = 0, slab_ = 0;
};

}  // namespace pellucid
