#pragma once

#include <memory>

#include "algorithms/distance_impostors/settings.hpp"
#include "algorithms/technique.hpp"

/// Classical environment mapping (Blinn and Newell 1976, references.bib: blinn1976), the baseline of Szirmay-Kalos et
/// al. 2005, and with proxy geometry (Bjorke 2004, references.bib: bjorke2004).
namespace pellucid::environment_map {

enum class Parallax { none, box, sphere };

struct Parameters {
  Parallax parallax = Parallax::none;
  float proxy_radius_m = 0;
  int cube_size = 512;
  distance_impostors::CubeFormat cube_format = distance_impostors::CubeFormat::half;
  distance_impostors::CubePass cube_pass = distance_impostors::CubePass::automatic;
  distance_impostors::Anchor reference_point = distance_impostors::Anchor::object;
  float reference_x_m = 0, reference_y_m = 0, reference_z_m = 0;
  distance_impostors::Refresh refresh = distance_impostors::Refresh::frames;
  int refresh_frames = 1;
  float refresh_ms = 150;
  float refresh_distance_m = 0.25F;
  int mutual = 1;

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
    visit(PARAM(cube_size), {.range = {64, 2048},
                             .cite = "Szirmay-Kalos et al. 2005, Sec. 6",
                             .doc = "width and height of a face of the cube maps",
                             .when = Change::precompute,
                             .unit = "texels"});
    visit(PARAM(cube_format), {.cite = "Szirmay-Kalos et al. 2005, Sec. 3",
                               .doc = "bits of a channel of the cube maps: 16 (half) or 32 (single)",
                               .when = Change::precompute,
                               .choices = "half|single"});
    visit(PARAM(cube_pass), {.cite = "beyond the paper",
                             .doc = "faces of a cube map chosen by a geometry shader, by the vertex shader (automatic: "
                                    "where it can), or drawn one by one",
                             .when = Change::precompute,
                             .choices = "automatic|geometry|vertex|faces"});
    visit(PARAM(reference_point), {.symbol = "o",
                                   .cite = "Szirmay-Kalos et al. 2005, Sec. 2",
                                   .doc = "where the maps are drawn from: each object's middle, the middle of the "
                                          "opaque objects, or a point",
                                   .when = Change::precompute,
                                   .choices = "object|scene|point"});
    visit(PARAM(reference_x_m), {.range = {-1e4, 1e4},
                                 .cite = "Szirmay-Kalos et al. 2005, Sec. 2",
                                 .doc = "x of that point",
                                 .when = Change::precompute,
                                 .unit = "m"});
    visit(PARAM(reference_y_m), {.range = {-1e4, 1e4},
                                 .cite = "Szirmay-Kalos et al. 2005, Sec. 2",
                                 .doc = "y of that point",
                                 .when = Change::precompute,
                                 .unit = "m"});
    visit(PARAM(reference_z_m), {.range = {-1e4, 1e4},
                                 .cite = "Szirmay-Kalos et al. 2005, Sec. 2",
                                 .doc = "z of that point",
                                 .when = Change::precompute,
                                 .unit = "m"});
    visit(PARAM(refresh), {.cite = "Szirmay-Kalos et al. 2005, Sec. 6",
                           .doc = "draw an object's maps once, every refresh_frames frames, every refresh_ms, or when "
                                  "it has moved by refresh_distance_m",
                           .choices = "once|frames|interval|movement"});
    visit(PARAM(refresh_frames), {.range = {1, 100000},
                                  .cite = "Szirmay-Kalos et al. 2005, Sec. 6",
                                  .doc = "frames from one drawing to the next"});
    visit(PARAM(refresh_ms), {.range = {0, 60000},
                              .cite = "Szirmay-Kalos et al. 2005, Sec. 6",
                              .doc = "time from one drawing to the next",
                              .unit = "ms"});
    visit(PARAM(refresh_distance_m), {.range = {0, 1e4},
                                      .cite = "Szirmay-Kalos et al. 2005, Sec. 1",
                                      .doc = "movement of the reference point that calls for new maps",
                                      .unit = "m"});
    visit(PARAM(mutual),
          {.range = {0, 4},
           .cite = "Szirmay-Kalos et al. 2005, Sec. 6",
           .doc = "times that the other mirrors, metals and dielectrics are drawn into each one's maps"});
  }
};
static_assert(well_formed<Parameters>());

const ParameterTable& table();
std::unique_ptr<Technique> make();

}  // namespace pellucid::environment_map
