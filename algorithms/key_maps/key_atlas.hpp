#pragma once

#include <cstdint>
#include <vector>

#include "algorithms/key_maps/key_chain.hpp"

/// A chain of key maps as one flat picture, which shaders/translucency.glsl looks up. A cube map with mipmaps would do,
/// but what a fetch from it takes besides its texels (the face, the level, what joins two faces) is then done anew for
/// each level, and by a processor in software.
namespace pellucid::scattering {

/// The faces stand one below the other, `face_rows` rows each. In a face the first map is at the left, the others
/// beside it from the top down, each with a border, one texel wide, of its neighbours' texels: bilinear fetches join
/// across the edges of the cube as GL_TEXTURE_CUBE_MAP_SEAMLESS has them.
struct KeyAtlas {
  int map_size = 0;  ///< n: texels along a face of the first map, a power of two; map l has n / 2^l
  int face_rows = 0;
  int width = 0, height = 0;
  /// Half precision as the chain keeps it, divided by its scale; 0 between the maps.
  std::vector<std::uint16_t> half_rgba;
};

KeyAtlas key_atlas(const KeyChain&);

}  // namespace pellucid::scattering
