#pragma once

#include <cstdint>
#include <vector>

#include "algorithms/scene/images/image.hpp"

/// Drops that grow, run down a surface along −v, and merge where they touch: a small simulation in whole numbers, so
/// that it is the same on every machine. GLSL twin: algorithms/translucent_relief/rain.comp.glsl.
namespace pellucid {

inline constexpr int kRainUnits = 4096;  ///< of length, along a side of the map
inline constexpr int kRainSteps = 60;    ///< a second
inline constexpr int kMostRainDrops = 256;

struct RainOptions {
  std::uint32_t seed = 1;
  int drops = 96;     ///< at most kMostRainDrops
  int largest = 200;  ///< radius of the largest [units]
  int fall = 16;      ///< how fast a drop runs: units a step for each 16 of its radius above what sticks
};

struct RainDrop {
  int x = 0, y = 0, radius = 0;  ///< [units]
  int life = 0;                  ///< how often it has merged into another and begun anew
};

/// The drops after `steps` steps from a dry start.
std::vector<RainDrop> rain_drops(const RainOptions&, int steps);

/// Heights of the drops' surface in metres over a ground, `below_m` where there is none; the largest drop is `height_m`
/// high above where its middle stands.
Image rain_surface(const std::vector<RainDrop>&, const RainOptions&, const Image& ground_m, float below_m,
                   float height_m);

}  // namespace pellucid
