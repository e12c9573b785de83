#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/scene/scene.hpp"

namespace pellucid::scattering {

/// InputError when the environment's image is not twice as wide as high, or has a pixel that is not finite or negative
/// by more than a twentieth of the mean; less than that is kept as it is.
void check_environment(const Environment&);

/// Radiance over the sphere by latitude and longitude, oriented as Environment has it: row 0 at +y, the middle column
/// at −z. Twice as wide as high.
class SphereMap {
 public:
  SphereMap() = default;
  SphereMap(int width, int height);
  explicit SphereMap(const Image&);
  /// The map of an environment without its scale.
  SphereMap(const Environment&, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  double polar(int y) const { return (y + 0.5) * std::numbers::pi / height_; }  ///< angle from +y
  double sine(int y) const { return sines_[static_cast<std::size_t>(y)]; }
  double area(int y) const { return areas_[static_cast<std::size_t>(y)]; }  ///< solid angle of a cell [sr]
  /// The cosine of the azimuth that a column stands for: 0 at −z, a quarter turn at +x.
  double column_cosine(int x) const { return column_cosines_[static_cast<std::size_t>(x)]; }
  double column_sine(int x) const { return column_sines_[static_cast<std::size_t>(x)]; }
  const float* row(int y) const { return rgb_.data() + index(0, y); }
  glm::dvec3 direction(int x, int y) const;  ///< unit, through a cell's middle

  void set(int x, int y, const glm::dvec3& radiance);
  /// Columns wrap, and rows beyond a pole come down on its other side.
  glm::dvec3 across_poles(int x, int y) const;
  glm::dvec3 at(const glm::dvec3& direction) const;  ///< bilinear; unit
  glm::dvec3 mean() const;                           ///< over the sphere
  SphereMap halved() const;                          ///< means over two by two cells; both sides even
  SphereMap resampled(int height) const;             ///< bilinear

 private:
  std::size_t index(int x, int y) const {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)) * 3;
  }
  int width_ = 0, height_ = 0;
  std::vector<double> sines_, areas_, column_cosines_, column_sines_;
  std::vector<float> rgb_;
};

/// Direction through a cube map's texel, unit, and its solid angle [sr].
glm::dvec3 texel_direction(int size, int face, int x, int y);
double texel_area(int size, int x, int y);

}  // namespace pellucid::scattering
