#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/geocube/cones/lanes.hpp"
#include "algorithms/geocube/cube_grid.hpp"

/// Quadtrees over the faces of a cube map whose texels hold points: what asks for one point among all of them looks at
/// a few patches of each level instead.
namespace pellucid::geocube {

inline constexpr std::uint32_t kNoCell = ~0U;

/// One point for each texel, or none.
struct Sheet {
  std::vector<glm::dvec3> points;  ///< relative to the cube's centre
  std::vector<char> present;       ///< 0: the texel's direction does not meet this sheet
};

/// The four quarters of a tree's cell side by side. Each is a patch: its
/// points lie at centre + a·edges[0] + b·edges[1] + c·edges[2] with a, b, c in [−1, 1]. The first two edges follow the
/// rows and columns of texels, so that a piece of a smooth surface is thin along the third.
struct Quarters {
  FourVectorsKept centre;
  std::array<FourVectorsKept, 3> edges;
  FourKept size{{-1, -1, -1, -1}};  ///< at least the largest coordinate of a point; below 0: no points
  FourKept gap;                     ///< infinite where some texel has no point, else 0
  std::array<std::uint32_t, 4> child{kNoCell, kNoCell, kNoCell, kNoCell};  ///< a cell, or a texel in the lowest cells
};

class PatchTree {
 public:
  /// The grid has at least two texels along an edge.
  PatchTree(const CubeGrid& grid, const Sheet& sheet);

  int n() const { return n_; }  ///< texels along a face's edge
  /// One for each face.
  const std::array<std::uint32_t, 6>& roots() const { return roots_; }
  const Quarters& quarters(std::uint32_t cell) const { return cells_[cell]; }
  /// The cell's quarters are texels.
  bool lowest(std::uint32_t cell) const { return cell < lowest_; }

 private:
  int n_ = 0;
  std::vector<Quarters> cells_;  // by level from the lowest up, face, row
  std::array<std::uint32_t, 6> roots_{};
  std::uint32_t lowest_ = 0;
};

}  // namespace pellucid::geocube
