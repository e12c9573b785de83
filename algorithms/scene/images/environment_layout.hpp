#pragma once

#include <optional>
#include <string>
#include <vector>

#include "algorithms/scene/images/picture_file.hpp"

namespace pellucid {

/// How a picture covers the sphere of directions.
enum class EnvironmentLayout {
  lat_long,    ///< row 0 at +y, the middle column at −z, +x to its right
  cube_strip,  ///< faces +x, −x, +y, −y, +z, −z from the top down or from left to right
  cube_cross,  ///< 4:3 or 3:4, unfolded around −z: −x to its left, +y above it; in 3:4 +z hangs upside down below −y
  mirror_ball,  ///< a mirroring ball that fills the picture, seen from far along −z: its middle mirrors +z
  angular       ///< the distance from the middle, which is −z, is in proportion to the angle
};

/// The picture as a lat-long one, bilinearly resampled where it is laid out otherwise (a face of n pixels gives 4n×2n,
/// a ball of diameter d 2d×d). Faces are seen from inside, upright: those at the side with +y up, +y with +z up, −y
/// with −z up, as OpenEXR lays them out ("OpenEXR Technical Introduction", Environment Maps); where the file's
/// attribute says that it is such a map, pixels at a face's border lie on the cube's edges. Without a `layout` a file
/// is what its attribute says, else lat-long. A layout that is only likely (a shape that is not 2:1, a part that is
/// missing) goes to `warnings`. Throws InputError: a shape that does not fit the layout, or one that is that of a ball;
/// a pixel that is not finite or above `most` [radiance].
Image to_lat_long(PictureFile, std::optional<EnvironmentLayout> layout, double most,
                  std::vector<std::string>& warnings);

}  // namespace pellucid
