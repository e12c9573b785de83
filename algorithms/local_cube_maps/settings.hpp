#pragma once

#include <optional>

#include <glm/glm.hpp>

#include "algorithms/local_cube_maps/hit_search.hpp"
#include "algorithms/raster/cube_pass.hpp"
#include "algorithms/raster/translucency.hpp"

/// The settings of local cube maps and of what rays find in them.
namespace pellucid::local_cube_maps {

/// Bits of a channel of the cube maps: 16 or 32.
enum class CubeFormat { half, single };
/// Where the distance is kept.
enum class DistanceStore { alpha, texture };
/// When the maps of an object are drawn again.
enum class Refresh { once, frames, interval, movement };
/// Where the reference point of an object's maps lies.
enum class Anchor { object, scene, point };

struct MapSettings {
  int cube_size = 512;
  CubeFormat format = CubeFormat::half;
  DistanceStore store = DistanceStore::texture;
  CubeLayers layers = CubeLayers::geometry;
  Anchor anchor = Anchor::object;
  glm::vec3 anchor_point{0.0F};
  Refresh refresh = Refresh::frames;
  int refresh_frames = 1;
  float refresh_ms = 150;
  float refresh_distance_m = 0.25F;
  int mutual = 1;  ///< how often the other objects are drawn into each one's maps
  int refractor_size = 256;
};

/// How a ray finds its light in the maps.
enum class RayLookup {
  direction,  ///< classical: by its direction alone
  box,        ///< where it leaves the box around the opaque objects (Bjorke 2004)
  sphere,     ///< where it leaves a sphere about the reference point (Bjorke 2004)
  search      ///< where the stored distances say
};
struct LookupSettings {
  RayLookup kind = RayLookup::search;
  HitSearch search;
  bool bare = false;         ///< the fetches of the search and nothing else: what `pellucid bench` compares with
  int bounces = 2;           ///< refractions
  int internal = 2;          ///< reflections inside, after which all that is left leaves
  float proxy_radius_m = 0;  ///< 0: the mean half side of the box
  /// The model for scattering media, with two refractions; none: only absorption acts.
  std::optional<TranslucencySettings> translucency{};
};

}  // namespace pellucid::local_cube_maps
