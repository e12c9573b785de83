#pragma once

#include <memory>

#include "algorithms/local_cube_maps/map_parameters.hpp"
#include "algorithms/technique.hpp"

/// Approximate ray tracing in cube maps of radiance and distance: Szirmay-Kalos et al. 2005 (references.bib:
/// szirmaykalos2005).
namespace pellucid::distance_impostors {

using local_cube_maps::DistanceStore;
using local_cube_maps::LookupSettings;
using local_cube_maps::MapParameters;
using local_cube_maps::MapSettings;
using local_cube_maps::Scheme;

enum class CausticRefresh { changed, every_frame };

struct Parameters : MapParameters {
  int iterations = 2;
  Scheme scheme = Scheme::false_position;
  int linear_steps = 64;
  DistanceStore distance = DistanceStore::texture;
  int bounces = 2;
  int refractor_size = 256;
  int internal_reflections = 2;
  Transfer transfer = Transfer::unscattered;
  bool caustics = false;
  int caustic_size = 64;
  int light_map_size = 256;
  float splat_sigma = 1;
  CausticRefresh caustic_refresh = CausticRefresh::every_frame;

  static constexpr void parameters(auto& self, auto&& visit) {
    visit(PARAM(iterations), {.symbol = "NITER",
                              .range = {-1, 32},
                              .cite = "Sec. 2.2",
                              .doc = "refinements of the hit; -1 is the first guess p, 0 the second, l; of the linear "
                                     "scheme: bisections",
                              .when = Change::program});
    visit(PARAM(scheme), {.cite = "Sec. 2.2",
                          .doc = "root finding: secant, false position, or (beyond the paper) linear search, and "
                                 "bisection or false position within the crossing",
                          .when = Change::program,
                          .choices = "secant|false_position|linear|linear_false_position"});
    visit(PARAM(linear_steps), {.range = {2, 1024},
                                .cite = "beyond the paper",
                                .doc = "steps of the linear schemes, equal in angle",
                                .when = Change::program});
    map_parameters(self, visit, kOwn);
    visit(PARAM(distance), {.cite = "Sec. 6",
                            .doc = "keep the distance in the radiance's alpha, or in a texture of its own",
                            .when = Change::precompute,
                            .choices = "alpha|texture"});
    visit(PARAM(bounces), {.range = {1, 2},
                           .cite = "Sec. 4",
                           .doc = "refractions: where a ray enters, or also where it leaves, by the refractor map",
                           .when = Change::precompute});
    visit(PARAM(refractor_size), {.range = {16, 2048},
                                  .cite = "Sec. 4",
                                  .doc = "width and height of a face of the refractor maps",
                                  .when = Change::precompute,
                                  .unit = "texels"});
    visit(PARAM(internal_reflections), {.range = {0, 8},
                                        .cite = "beyond the paper",
                                        .doc = "reflections inside an object, after which all that is left leaves; "
                                               "with 2 bounces",
                                        .when = Change::program});
    visit(PARAM(transfer),
          {.cite = "Chan and Wang 2005, Sec. 3.3",
           .doc = "what stands for the transmission of a scattering medium, with 2 bounces: nothing, a "
                  "Gaussian and a constant, these with the unscattered part apart, or two Gaussians",
           .when = Change::precompute,
           .choices = kTransfers});
    visit(PARAM(caustics), {.cite = "Sec. 5",
                            .doc = "land the light of shadow-casting lights that the objects send on",
                            .when = Change::precompute});
    visit(PARAM(caustic_size), {.range = {32, 1024},
                                .cite = "Sec. 5",
                                .doc = "width and height of the photon map that a light sees an object through",
                                .when = Change::precompute,
                                .unit = "texels"});
    visit(PARAM(light_map_size), {.range = {32, 2048},
                                  .cite = "Sec. 5",
                                  .doc = "width and height of a receiver's light map",
                                  .when = Change::precompute,
                                  .unit = "texels"});
    visit(PARAM(splat_sigma), {.symbol = "σ",
                               .range = {0.25, 16},
                               .cite = "Sec. 5",
                               .doc = "standard deviation of the Gaussian that a photon is splatted as",
                               .when = Change::precompute,
                               .unit = "texels"});
    visit(PARAM(caustic_refresh), {.cite = "Sec. 6",
                                   .doc = "trace photons only when lights, objects or maps changed, or in every frame",
                                   .when = Change::precompute,
                                   .choices = "changed|every_frame"});
  }
};
static_assert(local_cube_maps::well_formed_with_maps<Parameters>());

/// The parameters' meaning as settings. A context must be current.
MapSettings map_settings(const Parameters&);
LookupSettings lookup_settings(const Parameters&);

const ParameterTable& table();
std::unique_ptr<Technique> make();

}  // namespace pellucid::distance_impostors
