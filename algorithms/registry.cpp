#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "algorithms/bare_frame.hpp"
#include "algorithms/distance_impostors/bench/bare_impostors.hpp"
#include "algorithms/distance_impostors/distance_impostors.hpp"
#include "algorithms/environment_map/environment_map.hpp"
#include "algorithms/front_refraction/front_refraction.hpp"
#include "algorithms/geocube/bench/bare_glass.hpp"
#include "algorithms/geocube/geocube.hpp"
#include "algorithms/ray_marching/ray_marching.hpp"
#include "algorithms/sampling_hulls/bench/bare_hulls.hpp"
#include "algorithms/sampling_hulls/sampling_hulls.hpp"
#include "algorithms/screen_space_refraction/screen_space_refraction.hpp"
#include "algorithms/technique.hpp"
#include "algorithms/translucent_relief/bench/bare_relief.hpp"
#include "algorithms/translucent_relief/translucent_relief.hpp"
#include "algorithms/volume_slices/volume_slices.hpp"

namespace pellucid {

// One line for each paper or baseline; the other is in CMakeLists.txt.
static const std::array kTechniques{
    TechniqueInfo{.name = "distance_impostors",
                  .title = "Distance impostors",
                  .citation = "szirmaykalos2005",
                  .doc = "reflection and refraction by searching for rays' hits in cube maps of radiance and distance",
                  .table = distance_impostors::table,
                  .make = distance_impostors::make,
                  .interfaces = true,
                  .maps = true,
                  .classes = true},
    TechniqueInfo{.name = "environment_map",
                  .title = "Environment map",
                  .citation = "blinn1976",
                  .baseline = true,
                  .doc = "classical environment mapping, or with a box or sphere as proxy geometry",
                  .table = environment_map::table,
                  .make = environment_map::make,
                  .interfaces = true},
    TechniqueInfo{.name = "front_refraction",
                  .title = "Front refraction",
                  .citation = "chan2005",
                  .baseline = true,
                  .doc = "refraction where the eye's ray enters, and nowhere else",
                  .table = front_refraction::table,
                  .make = front_refraction::make,
                  .interfaces = true},
    TechniqueInfo{.name = "geocube",
                  .title = "Geocube",
                  .citation = "chan2005",
                  .doc = "refraction at both sides and internal reflection by cube maps of distances and cones",
                  .table = geocube::table,
                  .make = geocube::make,
                  .interfaces = true,
                  .maps = true},
    TechniqueInfo{.name = "sampling_hulls",
                  .title = "Sampling hulls",
                  .citation = "imagire2007",
                  .doc = "anti-aliased volumes: M hulls parallel to the screen, N points on the valid path in each",
                  .table = sampling_hulls::table,
                  .make = sampling_hulls::make},
    TechniqueInfo{.name = "ray_marching",
                  .title = "Ray marching",
                  .citation = "kruger2003",
                  .baseline = true,
                  .doc = "the volume in one pass, N points on each ray, with interleaved jitter if wanted",
                  .table = ray_marching::table,
                  .make = ray_marching::make},
    TechniqueInfo{.name = "screen_space_refraction",
                  .title = "Screen-space refraction",
                  .citation = "wyman2005",
                  .baseline = true,
                  .doc = "refraction at two interfaces, the far side as the screen shows it",
                  .table = screen_space_refraction::table,
                  .make = screen_space_refraction::make,
                  .interfaces = true},
    TechniqueInfo{.name = "translucent_relief",
                  .title = "Translucent relief",
                  .citation = "timonen",
                  .doc = "a translucent layer over a solid, height fields under a mesh: refraction, reflection, light "
                         "occlusion",
                  .table = translucent_relief::table,
                  .make = translucent_relief::make,
                  .maps = true,
                  .reliefs = true},
    TechniqueInfo{.name = "volume_slices",
                  .title = "Slices",
                  .citation = "cullip1994",
                  .baseline = true,
                  .doc = "the slice-based baseline: one plane a step, blended back to front",
                  .table = volume_slices::table,
                  .make = volume_slices::make},
};

// One line for each technique that `pellucid bench` can time; the order is that of the help text.
static const BareFrameInfo* const kBareFrames[] = {&sampling_hulls::bare_frame(), &distance_impostors::bare_frame(),
                                                   &geocube::bare_frame(), &translucent_relief::bare_frame()};

std::span<const BareFrameInfo* const> bare_frames() {
  return kBareFrames;
}

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
