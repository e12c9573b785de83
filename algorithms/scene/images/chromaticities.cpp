#include "algorithms/scene/images/chromaticities.hpp"

#include <cassert>
#include <cmath>
#include <cstddef>

#include "gl/error.hpp"

namespace pellucid {
namespace {

constexpr double kRounding = 1e-4;

bool close(const glm::dvec2& a, const glm::dvec2& b) {
  return std::abs(a.x - b.x) <= kRounding && std::abs(a.y - b.y) <= kRounding;
}

/// The tristimulus of luminance 1 with this chromaticity.
glm::dvec3 of_unit_luminance(const glm::dvec2& xy) {
  return {xy.x / xy.y, 1.0, (1 - xy.x - xy.y) / xy.y};
}

/// SMPTE RP 177: the primaries' tristimuli, scaled so that they add up to the white's.
glm::dmat3 to_xyz(const Chromaticities& c) {
  const auto column = [](const glm::dvec2& xy) { return glm::dvec3(xy, 1 - xy.x - xy.y); };
  const glm::dmat3 primaries(column(c.red), column(c.green), column(c.blue));
  const double volume = glm::determinant(primaries);
  if (!(std::abs(volume) > 1e-6) || !(std::abs(c.white.y) > 1e-6))
    throw InputError("the chromaticities in its header span no colour space");
  const glm::dvec3 scale = glm::inverse(primaries) * of_unit_luminance(c.white);
  for (int i = 0; i < 3; ++i) {
    if (!(std::isfinite(scale[i]) && std::abs(scale[i]) > 1e-9))
      throw InputError("the chromaticities in its header span no colour space");
  }
  return {primaries[0] * scale.x, primaries[1] * scale.y, primaries[2] * scale.z};
}

glm::dmat3 bradford(const glm::dvec2& from, const glm::dvec2& to) {
  const glm::dmat3 cone =
      glm::transpose(glm::dmat3(0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296));
  const glm::dvec3 ratio = (cone * of_unit_luminance(to)) / (cone * of_unit_luminance(from));
  return glm::inverse(cone) * glm::dmat3(ratio.x, 0, 0, 0, ratio.y, 0, 0, 0, ratio.z) * cone;
}

}  // namespace

bool Chromaticities::same_as(const Chromaticities& other) const {
  return close(red, other.red) && close(green, other.green) && close(blue, other.blue) && close(white, other.white);
}

glm::dmat3 to_rec709(const Chromaticities& from) {
  const Chromaticities rec709;
  glm::dmat3 xyz = to_xyz(from);
  const bool tristimuli = close(from.red, {1, 0}) && close(from.green, {0, 1}) && close(from.blue, {0, 0});
  if (!tristimuli) xyz = bradford(from.white, rec709.white) * xyz;
  return glm::inverse(to_xyz(rec709)) * xyz;
}

void convert(Image& image, const glm::dmat3& matrix) {
  assert(image.channels >= 3);
  const auto step = static_cast<std::size_t>(image.channels);
  for (std::size_t i = 0; i < image.pixels.size(); i += step) {
    float* p = image.pixels.data() + i;
    const glm::dvec3 out = matrix * glm::dvec3(p[0], p[1], p[2]);
    for (int c = 0; c < 3; ++c)
      p[c] = static_cast<float>(out[c]);
  }
}

}  // namespace pellucid
