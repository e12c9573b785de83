#pragma once

#include <cstdint>

#include "algorithms/scene/images/image.hpp"

/// Height fields by formula, seamless, deterministic for a seed. Rows from the bottom.
namespace pellucid {

enum class Pattern { flat, bricks, stones, noise, cells, gems, waves, drops, rain, file };

struct PatternOptions {
  Pattern kind = Pattern::flat;
  int width = 256, height = 256;  ///< texels
  std::uint32_t seed = 1;
  int columns = 4, rows = 8;       ///< of bricks; stones, cells and drops: so many along u and v
  float joint = 0.12F;             ///< width of mortar or gaps, a share of a brick's or cell's side
  int frequency = 4, octaves = 4;  ///< noise: periods across the map
  float roughness = 0.15F;         ///< share of the height that fine noise makes
  float contrast = 0.4F;           ///< of colours: the darkest tone is 1 − contrast
  float level = 1.0F;              ///< flat: the height; cells: how full
  int waves = 12;                  ///< number of sines
  float size_m = 1.0F;             ///< waves: what the map's side measures, for their speed in deep water
  double time_s = 0.0;
};

struct PatternMaps {
  Image heights;  ///< one channel in [0, 1]
  Image colors;   ///< three channels, or empty
};

/// All but drops, rain and file.
PatternMaps make_pattern(const PatternOptions&);

/// One wave of a surface of waves: height amplitude · cos(2π (cycles · uv) − speed · t + phase).
struct Sine {
  float cycles_u, cycles_v;  ///< whole numbers
  float amplitude;           ///< all of them sum to 1/2
  float phase, speed;        ///< rad, rad/s
};
inline constexpr int kMostSines = 32;
/// The waves of Pattern::waves; the surface is 1/2 + their sum.
void make_sines(const PatternOptions&, Sine* out);

/// Drops on a solid whose height in metres is `ground_m`: surface heights in metres, `below_m` where there is no drop.
struct DropOptions {
  std::uint32_t seed = 1;
  int columns = 8, rows = 8;  ///< a cell each, with a drop in it or not
  float share = 0.7F;         ///< of cells with a drop
  float radius = 0.5F;        ///< of the largest, as a share of a cell's shorter side
  float height_m = 0.01F;     ///< of the largest above where its middle stands
};
Image make_drops(const Image& ground_m, float below_m, const DropOptions&);

/// Slopes of one channel over u and v by central differences, repeated at the borders.
Image slopes_of(const Image& heights);

}  // namespace pellucid
