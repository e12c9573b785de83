#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/scene/images/image.hpp"

/// Height-mapped surfaces: what a polygon mesh may carry beneath it. The mesh is the lid; heights are metres along its
/// normal, 0 at the mesh and negative under it.
namespace pellucid {

struct ReliefMotion;  ///< of a layer that changes with time: motion.hpp in this folder

/// One height field. Its images have their rows from the bottom, as textures do; they are interpolated bilinearly
/// between texel centres and repeat.
struct ReliefLayer {
  Image heights;            ///< one channel, in [0, 1]: 0 is `low_m`, 1 is `high_m`
  float low_m = -0.1F;      ///< below `high_m`
  float high_m = 0.0F;      ///< at most 0
  bool normal_map = false;  ///< what `normals` holds
  Image normals;  ///< of a normal map: three channels, unit, v up; else two, the slopes of `heights` over u and v
  std::shared_ptr<const ReliefMotion> motion;  ///< what the heights were made by, if they move
  Image colors;                                ///< three channels that multiply the albedo; or empty
  glm::vec3 albedo{0.5F};                      ///< of the solid
  float specular = 0.0F;   ///< Phong's highlight, as a share of a white surface's radiance in the same light
  float exponent = 50.0F;  ///< Phong's
};

/// Air of varying index above the mesh, up to `height_m`: squared indices, u fastest, at texel centres over the mesh's
/// u and v (repeated), and at heights from 0 to `height_m`, both ends included.
struct ReliefAir {
  float height_m = 0.1F;
  glm::ivec3 size{1};
  std::vector<float> index2;
};

/// A solid and, above it in places, a translucent medium (Timonen, Sec. 3).
struct Relief {
  std::string name;
  glm::vec2 tiling{1.0F};  ///< how often the maps repeat over a unit of the mesh's texture coordinates
  bool cut = true;         ///< a ray that leaves [0, 1]² of the mesh's texture coordinates leaves the surface
  ReliefLayer solid;
  std::optional<ReliefLayer> translucent;  ///< the medium is where it lies above the solid
  float outside_index = 1.0F;              ///< n1, where the eye is
  float index = 1.33F;                     ///< n2, of the medium
  glm::vec3 absorption{0.0F};              ///< of the medium [1/m]
  glm::vec3 scattering{0.0F};              ///< of the medium [1/m]
  float anisotropy = 0.0F;                 ///< g of Henyey and Greenstein's phase function
  float intensification = 0.0F;            ///< share given back of what the medium's highlight loses by reflection
  std::optional<ReliefAir> air;
  std::uint64_t maps_revision = 0;  ///< raised when images or heights changed

  bool scatters() const { return translucent && scattering != glm::vec3(0.0F); }
  float low_m() const { return translucent ? glm::min(solid.low_m, translucent->low_m) : solid.low_m; }
  float high_m() const { return translucent ? glm::max(solid.high_m, translucent->high_m) : solid.high_m; }
};

}  // namespace pellucid
