#pragma once

#include <memory>

#include "algorithms/technique.hpp"

/// A translucent layer over a solid, both height fields under a mesh: Timonen (references.bib: timonen).
namespace pellucid::translucent_relief {

enum class Mapping { normal, relief };
enum class Search { linear, max_mip, cone_step, relaxed_cone_step };
enum class Motion { gpu, scene };
enum class Boxes { shared, separate };
enum class LocalRays { traced, planar_reflections, planar };
enum class Show { radiance, reflections, occlusion, steps };

struct Parameters {
  Mapping mapping = Mapping::relief;
  bool translucency = true;
  bool occlusion = true;
  bool absorption = true;
  Search search = Search::linear;
  Boxes boxes = Boxes::shared;
  LocalRays local_rays = LocalRays::traced;
  int view_steps = 64;
  int view_refinements = 6;
  int reflected_steps = 32;
  int reflected_refinements = 4;
  int refracted_steps = 32;
  int refracted_refinements = 4;
  int light_steps = 32;
  int light_refinements = 4;
  float steps_at_normal = 1.0F;
  int boundaries = 3;
  bool scattering = true;
  bool caustics = false;
  int caustic_resolution = 256;
  int object_steps = 32;
  float object_reach = 1.0F;
  int air_steps = 200;
  Motion motion = Motion::gpu;
  float bloom = 0.0F;
  float bloom_threshold = 1.0F;
  int bloom_downsampling = 4;
  float bloom_sigma = 4.0F;
  Show show = Show::radiance;

  static constexpr void parameters(auto& self, auto&& visit) {
    constexpr Range kSteps{1, 1024}, kRefinements{0, 24};
    visit(PARAM(mapping), {.cite = "Table 1",
                           .doc = "how the solid is drawn: normals and colours on the mesh itself, or its heights too",
                           .when = Change::program,
                           .choices = "normal|relief"});
    visit(PARAM(translucency), {.cite = "Algorithm 1; Table 1",
                                .doc = "draw the translucent layer; needs mapping = relief",
                                .when = Change::program});
    visit(PARAM(occlusion), {.cite = "Algorithm 2; Table 1",
                             .doc = "let the solid and every boundary of the medium keep light away",
                             .when = Change::program});
    visit(PARAM(absorption), {.symbol = "d0",
                              .cite = "Eq. 1; Table 1",
                              .doc = "let the medium absorb light on the way to the eye and, with occlusion, from the "
                                     "lights",
                              .when = Change::program});
    visit(PARAM(search), {.cite = "Sec. 2; Tevs et al. 2008; Dummer 2006; Policarpo and Oliveira 2007",
                          .doc = "how rays look for the layers: by equal steps; exactly, through a pyramid of greatest "
                                 "and least heights; from empty cone to empty cone; or, where rays fall, through cones "
                                 "that may end in the solid",
                          .when = Change::precompute,
                          .choices = "linear|max_mip|cone_step|relaxed_cone_step"});
    visit(PARAM(boxes),
          {.cite = "Sec. 3",
           .doc = "search view rays in one bounding box for both layers, or in each layer's own, as other searches "
                  "than linear always do",
           .when = Change::program,
           .choices = "shared|separate"});
    visit(PARAM(local_rays), {.cite = "Sec. 3.2",
                              .doc = "how reflected and refracted rays meet the solid: traced, or, reflected ones or "
                                     "both, on a plane at its mean height",
                              .when = Change::program,
                              .choices = "traced|planar_reflections|planar"});
    visit(PARAM(view_steps), {.range = kSteps, .cite = "Sec. 2", .doc = "linear search's steps along view rays"});
    visit(PARAM(view_refinements),
          {.range = kRefinements, .cite = "Sec. 2", .doc = "halvings of the last step of view rays"});
    visit(PARAM(reflected_steps), {.range = kSteps, .cite = "Sec. 3", .doc = "the same of reflected rays: steps"});
    visit(PARAM(reflected_refinements), {.range = kRefinements, .cite = "Sec. 3", .doc = "and halvings"});
    visit(PARAM(refracted_steps), {.range = kSteps, .cite = "Sec. 3", .doc = "the same of refracted rays: steps"});
    visit(PARAM(refracted_refinements), {.range = kRefinements, .cite = "Sec. 3", .doc = "and halvings"});
    visit(PARAM(light_steps), {.range = kSteps, .cite = "Sec. 3.1", .doc = "the same of light rays: steps"});
    visit(PARAM(light_refinements), {.range = kRefinements, .cite = "Sec. 3.1", .doc = "and halvings"});
    visit(PARAM(steps_at_normal), {.range = {0.01, 1},
                                   .cite = "Sec. 3.2; Tatarchuk 2006",
                                   .doc = "share of the steps that a ray along the mesh's normal takes, with all of "
                                          "them at grazing angles; 1: as many at every angle"});
    visit(PARAM(boundaries), {.range = {1, 16},
                              .cite = "Algorithm 2",
                              .doc = "boundaries of the medium that a light ray passes; those beyond are left out"});
    visit(PARAM(scattering), {.cite = "Sec. 6, future work; Chan and Wang 2005, Sec. 3.3",
                              .doc = "with absorption: let media that scatter blur the solid and shine themselves, by "
                                     "the transfer functions of a slab; else they absorb alone",
                              .when = Change::program});
    visit(PARAM(caustics),
          {.cite = "Sec. 4.1, future work",
           .doc = "let the medium's surface gather the lights on the solid under it, in place of straight light "
                  "rays there; needs meshes whose texture coordinates lie in [0, 1]",
           .when = Change::program});
    visit(PARAM(caustic_resolution),
          {.range = {16, 1024},
           .cite = "beyond the paper",
           .doc = "texels of the maps of that light along a side of the mesh's texture; its grid has half as many "
                  "cells",
           .unit = "texels"});
    visit(PARAM(object_steps),
          {.range = {0, 1024},
           .cite = "Sec. 6, future work",
           .doc = "steps of refracted and reflected rays in search of opaque objects on the screen, "
                  "in scenes that have some; 0: objects are neither refracted nor reflected",
           .when = Change::program});
    visit(PARAM(object_reach), {.range = {0.001, 1000},
                                .cite = "Sec. 6, future work",
                                .doc = "how far reflected rays look for objects above the surface",
                                .unit = "m"});
    visit(PARAM(air_steps), {.range = {0, 10000},
                             .cite = "Sec. 6, future work",
                             .doc = "steps of view rays through air of varying index above the mesh; 0: straight",
                             .when = Change::program});
    visit(PARAM(motion),
          {.cite = "Sec. 5",
           .doc = "where waves and drops are simulated: on the GPU at every change of time, or taken from "
                  "the scene, as searches other than linear always do",
           .when = Change::precompute,
           .choices = "gpu|scene"});
    visit(PARAM(bloom), {.range = {0, 4},
                         .cite = "Sec. 4, Fig. 9",
                         .doc = "how much light spills from what is too bright to be shown; 0: none"});
    visit(PARAM(bloom_threshold), {.range = {0, 100}, .cite = "Sec. 4", .doc = "radiance above which light blooms"});
    visit(PARAM(bloom_downsampling), {.range = {1, 16},
                                      .cite = "Sec. 4",
                                      .doc = "pixels of the picture along a side of the blurred one's",
                                      .unit = "px"});
    visit(PARAM(bloom_sigma), {.symbol = "σ",
                               .range = {0.1, 32},
                               .cite = "Sec. 4",
                               .doc = "standard deviation of the Gaussian, in the blurred picture's pixels",
                               .unit = "px"});
    visit(PARAM(show), {.cite = "Fig. 7; beyond the paper",
                        .doc = "the picture; reflections sampled from the surface in red, from the environment in "
                               "blue; the first light's occlusion of the solid; heights asked for over the steps",
                        .when = Change::program,
                        .choices = "radiance|reflections|occlusion|steps"});
  }
};
static_assert(well_formed<Parameters>());

const ParameterTable& table();
std::unique_ptr<Technique> make();

}  // namespace pellucid::translucent_relief
