#pragma once

#include <vector>

#include "algorithms/scene/images/image.hpp"

/// The data that accelerated searches precompute of a height field.
namespace pellucid::translucent_relief {

/// Two channels, the greatest and the least height: first of the cells between four neighbouring texel centres, cell
/// (x, y) having texel (x, y) at its lower corner; then of 2 × 2 cells of the level before, down to one. The sides are
/// powers of two, or InputError.
std::vector<Image> height_pyramid(const Image& heights);

/// One channel: at each texel the ratio, width in the map's unit over height, of the widest empty cone that stands
/// there on its apex (Dummer 2006), at most 1. In a map with a side above `kMostConeTexels` cones stand on the least
/// heights of its blocks among the greatest of the others.
inline constexpr int kMostConeTexels = 256;
Image cone_map(const Image& heights);

/// Two channels: cone_map(), for rays that rise, and the ratio of the widest relaxed cone, for rays that fall
/// (Policarpo and Oliveira 2007): one in which a ray goes into the solid and does not come out again, at most 1. Exact
/// over the rays that are asked: from four heights over the texel, in 32 directions, a texel at a time; in a reduced
/// map features smaller than its texels are not seen.
Image relaxed_cone_map(const Image& heights);

}  // namespace pellucid::translucent_relief
