#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/geocube/cube_grid.hpp"

/// Cones A and B of a geocube by branch and bound over a quadtree on each face of the cube map (the paper compares
/// every texel with every other). A tree's cell that cannot better is left out unseen; the results are those of the
/// full comparison. A search looks at some cells of each level, whatever their number, where the surface is smooth.
namespace pellucid::geocube {

/// One surface point for each texel, or none, and for each cell of the quadtrees a ball around its points.
struct Sheet {
  std::vector<glm::dvec3> points;  ///< relative to the cube's centre
  std::vector<char> present;       ///< 0: the texel's direction does not meet this sheet
};

class SheetTree {
 public:
  SheetTree(const CubeGrid& grid, Sheet sheet);

  struct Cell {  ///< a disc that holds the cell's points
    glm::dvec3 centre{0.0}, normal{0.0};
    double radius = -1;    ///< negative: no points
    double thickness = 0;  ///< how far the points are off the disc's plane, at most
    bool gaps = false;     ///< some texel has no point
    /// How far the points reach from the centre along a unit direction, at most.
    double reach(const glm::dvec3& direction) const {
      const double off = glm::dot(normal, direction);
      return std::abs(off) * thickness + std::sqrt(std::max(0.0, 1 - off * off)) * radius;
    }
  };
  struct Range {  ///< of the directions through a cell's texel centres
    glm::dvec3 axis{0.0};
    double cosine = 1, sine = 0;
  };

  const CubeGrid& grid() const { return grid_; }
  int levels() const { return static_cast<int>(offsets_.size()); }
  int width(int level) const { return widths_[static_cast<std::size_t>(level)]; }
  std::size_t at(int level, int face, int x, int y) const {
    const auto w = static_cast<std::size_t>(width(level));
    return offsets_[static_cast<std::size_t>(level)] +
           (static_cast<std::size_t>(face) * w + static_cast<std::size_t>(y)) * w + static_cast<std::size_t>(x);
  }
  const Cell& cell(std::size_t at) const { return cells_[at]; }
  const Range& range(std::size_t at) const { return ranges_[at]; }
  const Sheet& sheet() const { return sheet_; }

 private:
  void build(int level, int face, int x, int y);
  CubeGrid grid_;
  Sheet sheet_;
  std::vector<int> widths_;
  std::vector<std::size_t> offsets_;
  std::vector<Cell> cells_;
  std::vector<Range> ranges_;
};

/// A finite cone's place: from its apex along the axis to a base at `height`.
struct ConeA {
  glm::dvec3 apex{0.0};
  glm::dvec3 axis{0.0};  ///< unit
  double height = 0;
};
/// The largest cosine of the angle between the cone's axis and a surface point between apex and base: cos θ_A of the
/// widest cone that holds none (0 when there is no such point). `trees` are of all sheets that may stand in the way;
/// `hint` is a texel likely to be the one, and becomes it.
double cone_a_cosine(const ConeA&, const std::vector<const SheetTree*>& trees, std::size_t& hint);

/// The base of a cone B: the surface must stay within ±half_width of the tangent plane at S.
struct ConeB {
  glm::dvec3 axis{0.0};    ///< unit, from the cube's centre to S
  glm::dvec3 normal{0.0};  ///< unit
  double offset = 0;       ///< S·N
  double half_width = 0;   ///< ε/2
  bool breaks(const glm::dvec3& point) const { return std::abs(glm::dot(point, normal) - offset) > half_width; }
};
/// cos θ_B of the widest cone about the axis in which no texel's point breaks away from the plane, and none is missing:
/// the cosine of the nearest that does, −1 when there is none.
double cone_b_inscribed(const ConeB&, const SheetTree& tree, std::size_t& hint);
/// cos θ_B of the narrowest cone that holds the points which reach S along the cube map without leaving the planes: the
/// mesh "near S" of the paper, followed in 32 directions around S.
double cone_b_enclosing(const ConeB&, const Sheet& sheet, const CubeGrid& grid);

}  // namespace pellucid::geocube
