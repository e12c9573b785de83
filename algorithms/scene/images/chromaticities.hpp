#pragma once

#include <glm/glm.hpp>

#include "algorithms/scene/images/image.hpp"

namespace pellucid {

/// CIE 1931 xy of an RGB space's primaries and white.
struct Chromaticities {
  glm::dvec2 red{0.64, 0.33}, green{0.30, 0.60}, blue{0.15, 0.06}, white{0.3127, 0.3290};  ///< Rec. 709
  /// Within what a header of 32-bit floats rounds away.
  bool same_as(const Chromaticities&) const;
};

/// From this space's linear values to Rec. 709's. Another white is adapted by Bradford's transform (Lam 1985; ICC.1
/// Annex E), so that white stays white. CIE XYZ itself, told by its primaries (1, 0), (0, 1), (0, 0), is not: its
/// values are tristimuli, and the white in such a header is only their scale. Throws InputError when the primaries span
/// no space.
glm::dmat3 to_rec709(const Chromaticities&);

/// In place, R, G and B of each pixel.
void convert(Image&, const glm::dmat3&);

}  // namespace pellucid
