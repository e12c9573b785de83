#include <cassert>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "algorithms/scene/shapes/procedural.hpp"
#include "algorithms/scene/volumes/volume_rows.hpp"

namespace pellucid {

std::vector<float> make_cone_scattering(const glm::ivec3& size, const ConeShape& cone) {
  assert(cone.near_m > 0 && cone.near_m < cone.range_m);
  assert(cone.inner_angle_deg < cone.outer_angle_deg && cone.outer_angle_deg < 90);
  const double cos_inner = std::cos(glm::radians(cone.inner_angle_deg));
  const double cos_outer = std::cos(glm::radians(cone.outer_angle_deg));
  const double half = cone.range_m * std::tan(glm::radians(cone.outer_angle_deg));
  const auto across = [&](int i, int n) { return half * (2 * (i + 0.5) / n - 1); };
  std::vector<float> scattering(voxel_count(size), 0.0F);
  for_each_row(size, scattering, [&](int j, int k, std::span<float> row) {
    const double y = across(j, size.y);
    const double z = cone.near_m + (cone.range_m - cone.near_m) * (k + 0.5) / size.z;
    for (int i = 0; i < size.x; ++i) {
      const double x = across(i, size.x);
      const double distance2 = x * x + y * y + z * z;
      const double cosine = z / std::sqrt(distance2);
      // As light_irradiance() of shaders/lighting.glsl: smoothstep of the cosine over the squared distance.
      const double t = glm::clamp((cosine - cos_outer) / (cos_inner - cos_outer), 0.0, 1.0);
      row[static_cast<std::size_t>(i)] = static_cast<float>(t * t * (3 - 2 * t) / distance2);
    }
  });
  return scattering;
}

}  // namespace pellucid
