#pragma once

#include <glm/glm.hpp>

#include "algorithms/scene/noise.hpp"

namespace pellucid {

/// A direction at the angle of Henyey and Greenstein's phase function (references.bib: henyey1941) from `direction`;
/// `anisotropy` is its mean cosine. Both of unit length.
glm::dvec3 deflected(const glm::dvec3& direction, double anisotropy, Random&);

/// A direction about the unit vector `axis`, at that cosine from it and turned by a share of the full circle.
glm::dvec3 direction_about(const glm::dvec3& axis, double cosine, double turn);

}  // namespace pellucid
