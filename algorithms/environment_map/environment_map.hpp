#pragma once

#include <memory>

#include "algorithms/local_cube_maps/map_parameters.hpp"
#include "algorithms/technique.hpp"

/// Classical environment mapping (Blinn and Newell 1976, references.bib: blinn1976), the baseline of Szirmay-Kalos et
/// al. 2005, and with proxy geometry (Bjorke 2004, references.bib: bjorke2004).
namespace pellucid::environment_map {

enum class Parallax { none, box, sphere };

struct Parameters : local_cube_maps::MapParameters {
  Parallax parallax = Parallax::none;
  float proxy_radius_m = 0;

  static constexpr void parameters(auto& self, auto&& visit) {
    visit(PARAM(parallax), {.cite = "Bjorke 2004",
                            .doc = "look up by direction alone, or where the ray leaves the box around the opaque "
                                   "objects, or a sphere",
                            .when = Change::program,
                            .choices = "none|box|sphere"});
    visit(PARAM(proxy_radius_m), {.range = {0, 1e4},
                                  .cite = "Bjorke 2004",
                                  .doc = "radius of the sphere about the reference point, 0 for the mean half side of "
                                         "the box",
                                  .unit = "m"});
    map_parameters(self, visit, kOfAnother);
  }
};
static_assert(local_cube_maps::well_formed_with_maps<Parameters>());

const ParameterTable& table();
std::unique_ptr<Technique> make();

}  // namespace pellucid::environment_map
