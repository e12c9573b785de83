#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "algorithms/distance_impostors/distance_impostors.hpp"
#include "algorithms/environment_map/environment_map.hpp"
#include "algorithms/front_refraction/front_refraction.hpp"
#include "algorithms/geocube/geocube.hpp"
#include "algorithms/ray_marching/ray_marching.hpp"
#include "algorithms/sampling_hulls/sampling_hulls.hpp"
#include "algorithms/screen_space_refraction/screen_space_refraction.hpp"
#include "algorithms/technique.hpp"
#include "algorithms/translucent_relief/translucent_relief.hpp"
#include "algorithms/volume_slices/volume_slices.hpp"

namespace pellucid {

// One line for each paper or baseline; the other is in CMakeLists.txt.
static const std::array kTechniques{
    TechniqueInfo{"distance_impostors", "Distance impostors", "szirmaykalos2005", false,
                  "reflection and refraction by searching for rays' hits in cube maps of radiance and distance",
                  distance_impostors::table, distance_impostors::make, true, true, true},
    TechniqueInfo{"environment_map", "Environment map", "blinn1976", true,
                  "classical environment mapping, or with a box or sphere as proxy geometry", environment_map::table,
                  environment_map::make, true},
    TechniqueInfo{"front_refraction", "Front refraction", "chan2005", true,
                  "refraction where the eye's ray enters, and nowhere else", front_refraction::table,
                  front_refraction::make, true},
    TechniqueInfo{"geocube", "Geocube", "chan2005", false,
                  "refraction at both sides and internal reflection by cube maps of distances and cones",
                  geocube::table, geocube::make, true, true},
    TechniqueInfo{"sampling_hulls", "Sampling hulls", "imagire2007", false,
                  "anti-aliased volumes: M hulls parallel to the screen, N points on the valid path in each",
                  sampling_hulls::table, sampling_hulls::make},
    TechniqueInfo{"ray_marching", "Ray marching", "kruger2003", true,
                  "the volume in one pass, N points on each ray, with interleaved jitter if wanted",
                  ray_marching::table, ray_marching::make},
    TechniqueInfo{"screen_space_refraction", "Screen-space refraction", "wyman2005", true,
                  "refraction at two interfaces, the far side as the screen shows it", screen_space_refraction::table,
                  screen_space_refraction::make, true},
    TechniqueInfo{
        "translucent_relief", "Translucent relief", "timonen", false,
        "a translucent layer over a solid, height fields under a mesh: refraction, reflection, light occlusion",
        translucent_relief::table, translucent_relief::make, false, true, false, true},
    TechniqueInfo{"volume_slices", "Slices", "cullip1994", true,
                  "the slice-based baseline: one plane a step, blended back to front", volume_slices::table,
                  volume_slices::make},
};

std::span<const TechniqueInfo> techniques() {
  return kTechniques;
}

const TechniqueInfo& find_technique(std::string_view name) {
  std::vector<std::string> names;
  for (const TechniqueInfo& info : kTechniques) {
    if (info.name == name) return info;
    names.emplace_back(info.name);
  }
  const std::string near = nearest_name(name, names);
  throw InputError(fmt::format(
      "unknown technique '{}'; {}", name,
      near.empty() ? fmt::format("there are {}", fmt::join(names, ", ")) : fmt::format("did you mean '{}'?", near)));
}

}  // namespace pellucid
