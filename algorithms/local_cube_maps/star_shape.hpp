#pragma once

#include <string>

#include <glm/glm.hpp>

#include "algorithms/scene/scene.hpp"

/// A refractor map holds one distance for each direction, so that the object must be star-shaped: every point of its
/// surface is seen from one centre (Szirmay-Kalos et al. 2005, Sec. 4). This says by how much an object is not.
namespace pellucid::local_cube_maps {

struct StarShape {
  double hidden_area = 0;  ///< share of the area that faces the centre, so that other surface lies before it
  double folded = 0;       ///< share of the directions that such surface covers
  double uncovered = 0;    ///< share of the directions in which there is no surface, or none behind the centre
  bool exact() const { return folded < kTolerance && uncovered < kTolerance; }
  static constexpr double kTolerance = 1e-4;  ///< of rounding and of the seams of curved patches
};

/// The mesh's triangles are counter-clockwise from outside. `center` lies in the mesh's space.
StarShape measure_star_shape(const Mesh&, const glm::dvec3& center);

/// The middle of the bounding box or the centroid of the solid, whichever sees more of the surface.
glm::vec3 choose_center(const Mesh&);

/// True if every edge has a triangle on either side, and the triangles face outwards: from outside only fronts are
/// seen.
bool closed(const Mesh&);

/// One line: "refractor 'skull' is not star-shaped: 12.1 % of its area …".
std::string describe(const std::string& name, const StarShape&);

}  // namespace pellucid::local_cube_maps
