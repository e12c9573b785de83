#pragma once

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/geocube/cones/patch_tree.hpp"
#include "algorithms/geocube/cube_grid.hpp"

/// Cones A and B of a geocube by branch and bound over a quadtree on each face of the cube map (the paper compares
/// every texel with every other). A patch that cannot better is left out unseen; the results are those of the
/// full comparison. A search looks at some patches of each level, whatever their number, where the surface is smooth.
namespace pellucid::geocube {

/// A sheet of the surface and its tree.
struct SheetTree {
  SheetTree(const CubeGrid& grid, Sheet points) : sheet(std::move(points)), tree(grid, sheet) {}
  Sheet sheet;
  PatchTree tree;
};

/// A finite cone's place: from its apex along the axis, which passes through the cube's centre, to a base at `height`.
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
/// cos θ_B of the widest cone about the axis, up to 90°, in which no texel's point breaks away from the plane, and none
/// is missing: the cosine of the nearest that does. `directions` are those of all texels.
double cone_b_inscribed(const ConeB&, const SheetTree& surface, const SheetTree& directions, std::size_t& hint);
/// cos θ_B of the narrowest cone that holds the points which reach S along the cube map without leaving the planes: the
/// mesh "near S" of the paper, followed in 32 directions around S.
double cone_b_enclosing(const ConeB&, const Sheet& sheet, const CubeGrid& grid);

/// The directions of a grid's texels as a sheet.
Sheet unit_sphere(const CubeGrid& grid);

}  // namespace pellucid::geocube
