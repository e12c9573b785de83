#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/geocube/solid.hpp"

/// Where to put the cubes, which the paper leaves open (Sec. 5: an Art Gallery problem): so that few centres see as
/// much of the surface from inside as possible.
namespace pellucid::geocube {

struct PlacementOptions {
  int cubes = 2;
  double enough = 1.0;    ///< no more cubes once this share of the area is seen
  int candidates = 1500;  ///< points inside to choose from
  int samples = 6000;     ///< points of the surface, spread by area, that the choice is made by
  std::uint32_t seed = 1;
};

struct Placement {
  std::vector<glm::dvec3> centers;  ///< in order of choice
  std::vector<double> unseen;       ///< after each: the share of the whole surface's area that none so far sees
};

/// A greedy choice among points inside, each then moved about while that helps; the shares are of all triangles, not of
/// those sampled; a triangle counts as seen when its centroid is. Deterministic. Throws InputError when `cubes` is not
/// within [1, 16].
Placement place_cubes(const Solid&, const PlacementOptions&);

}  // namespace pellucid::geocube
