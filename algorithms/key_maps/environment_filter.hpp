#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "algorithms/key_maps/key_widths.hpp"
#include "algorithms/key_maps/sphere_map.hpp"
#include "algorithms/scene/scene.hpp"

/// Key maps: an environment filtered by Gaussians on the sphere, of one width each (Chan and Wang 2005, Sec. 3.1;
/// references.bib: chan2005).
namespace pellucid::scattering {

enum class SphereFilter {
  direct,      ///< a sum over the sphere, weighted by the angle
  three_maps,  ///< the paper's: three latitude-longitude maps with perpendicular poles, filtered as if they were flat
};
inline constexpr std::string_view kSphereFilters = "direct|three_maps";

/// The radiance of every face of one cube map, RGB, texels as gl/cube_faces.hpp numbers them, without the environment's
/// `scale`.
struct KeyMap {
  int size = 0;
  double width = 0;  ///< of the Gaussian [rad]
  std::vector<float> rgb;
};

/// An environment made ready for filtering. Keeps nothing of the scene.
class FilterSource {
 public:
  /// InputError when the image is not twice as wide as high, or holds what is no radiance.
  explicit FilterSource(const Environment&);
  ~FilterSource();
  FilterSource(FilterSource&&) noexcept;

  /// A map of `size` × `size` texels a face, filtered by exp(−θ²/(2·width²)), width > 0 [rad], in parallel.
  KeyMap filtered(SphereFilter, int size, double width) const;
  /// A map of the mean over the sphere in every texel.
  KeyMap mean(int size) const;
  glm::dvec3 mean() const { return mean_; }

 private:
  const SphereMap& map_for(double width, SphereMap& finer) const;
  KeyMap direct(int size, double width) const;
  KeyMap three_maps(int size, double width) const;

  std::vector<SphereMap> maps_;  // the source, and halved again and again
  glm::dvec3 mean_{0.0};
};

/// The chain of key maps for a source of `face_size`: entry l is of level l + 1 of KeyWidths. The last one holds the
/// mean.
std::vector<KeyMap> key_maps(const Environment&, const KeyWidths&, int face_size, SphereFilter,
                             const std::function<void(double share)>& progress = {});

/// Mean over the sphere of a cube map, by the solid angle of its texels.
glm::dvec3 mean_over_sphere(const KeyMap&);
/// Root mean square of the difference over that of the second map, over the sphere and all channels.
double relative_rms(const KeyMap&, const KeyMap& reference);

}  // namespace pellucid::scattering
