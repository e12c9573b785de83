#pragma once

#include <memory>

#include "algorithms/geocube/cubes.hpp"
#include "algorithms/raster/translucency.hpp"
#include "algorithms/technique.hpp"

/// Refraction at both sides of a closed object and internal reflection: Chan and Wang 2005 (references.bib: chan2005).
namespace pellucid::geocube {

enum class Cones { none, a, b, c, ab, ac, bc, abc };
enum class Placing { automatic, middle, hand };
enum class Ask { behind, always };
enum class Functions { evaluated, table };
enum class SearchStage { fragment, split };
enum class Show { radiance, steps, length, bounded, cube, internal_reflection };

struct Parameters {
  int cubes = 2;
  Placing placement = Placing::automatic;
  int resolution = 64;
  int layers = 1;
  float epsilon = 0.04F;
  ConeBase cone_b = ConeBase::inscribed;
  Cones cones = Cones::abc;
  bool sphere = true;
  Holes holes = Holes::refuse;
  int iterations = 10;
  float min_step = 0.002F;
  int switches = 1;
  Ask ask = Ask::behind;
  int refine = 2;
  int reflections = 1;
  float cut = 1e-4F;
  Functions functions = Functions::evaluated;
  int table_size = 256;
  SearchStage stage = SearchStage::fragment;
  int vertex_iterations = 6;
  Transfer transfer = Transfer::unscattered;
  int face_size = 512;
  float omega = 0.02F;
  scattering::SphereFilter key_filter = scattering::SphereFilter::direct;
  float widening = 1;
  Show show = Show::radiance;

  static constexpr void parameters(auto& self, auto&& visit) {
    visit(PARAM(cubes),
          {.range = {1, 16},
           .cite = "Sec. 2.3",
           .doc = "cubes in each object, at most: of automatic placement, or the first of those that the scene "
                  "file gives",
           .when = Change::precompute});
    visit(PARAM(placement), {.cite = "Sec. 5",
                             .doc = "where the cubes lie: where they see most of the surface, one in the middle of the "
                                    "bounds, or at the object's cubes = [[x, y, z], …] in the scene file",
                             .when = Change::precompute,
                             .choices = "automatic|middle|hand"});
    visit(PARAM(resolution), {.range = {8, 512},
                              .cite = "Sec. 2.1",
                              .doc = "width and height of a face of the cube maps",
                              .when = Change::precompute,
                              .unit = "texels"});
    visit(PARAM(layers), {.range = {1, 8},
                          .cite = "Sec. 5, future work",
                          .doc = "intervals of the inside kept along a direction: with more than one, one cube serves "
                                 "any shape",
                          .when = Change::precompute});
    visit(PARAM(epsilon), {.symbol = "ε",
                           .range = {1e-5, 1},
                           .cite = "Sec. 2.1",
                           .doc = "thickness about the tangent plane that cone B allows the surface, as a share of the "
                                  "object's diagonal",
                           .when = Change::precompute});
    visit(PARAM(cone_b), {.cite = "Sec. 2.1",
                          .doc = "the widest cone in which the surface stays within ε, or the smallest that holds the "
                                 "mesh near by within ε",
                          .when = Change::precompute,
                          .choices = "inscribed|enclosing"});
    visit(PARAM(cones), {.cite = "Sec. 2.1",
                         .doc = "which of cones A, B and C are used",
                         .when = Change::precompute,
                         .choices = "none|a|b|c|ab|ac|bc|abc"});
    visit(PARAM(sphere), {.symbol = "D", .cite = "Sec. 2.1", .doc = "use sphere D", .when = Change::precompute});
    visit(PARAM(holes), {.cite = "beyond the paper",
                         .doc = "what to do with an open mesh: refuse it, or cap its holes",
                         .when = Change::precompute,
                         .choices = "refuse|cap"});
    visit(PARAM(iterations),
          {.range = {1, 4096}, .cite = "Sec. 4", .doc = "bound on the steps of a search; the paper takes 5 to 10"});
    visit(PARAM(min_step), {.symbol = "δ",
                            .range = {1e-6, 0.1},
                            .cite = "Sec. 2.3",
                            .doc = "least step, as a share of the object's diagonal"});
    visit(PARAM(switches), {.range = {0, 15},
                            .cite = "Sec. 2.3",
                            .doc = "other cubes asked, by the plane rule, before a point counts as outside; 1 in the "
                                   "paper"});
    visit(PARAM(ask), {.cite = "beyond the paper",
                       .doc = "when others are asked: where the directions about the point meet the solid again behind "
                              "the surface, or always, as in the paper",
                       .choices = "behind|always"});
    visit(PARAM(refine), {.range = {0, 8},
                          .cite = "beyond the paper",
                          .doc = "tangent-plane steps from the point found back to the surface; 0: the surface point "
                                 "fetched last, as in the paper"});
    visit(PARAM(reflections), {.range = {0, 16},
                               .cite = "Sec. 2",
                               .doc = "internal reflections followed; the paper has 0 and 1. Light that needs more is "
                                      "left out"});
    visit(PARAM(cut), {.range = {0, 1},
                       .cite = "beyond the paper",
                       .doc = "share of a pixel's light below which an internal reflection is not followed; about 0.05 "
                              "leaves total reflection alone"});
    visit(PARAM(functions), {.symbol = "C*, S*",
                             .cite = "Sec. 4",
                             .doc = "evaluate the steps' functions, or look them up in a texture as the paper does",
                             .when = Change::program,
                             .choices = "evaluated|table"});
    visit(PARAM(table_size), {.range = {16, 2048},
                              .cite = "Sec. 4",
                              .doc = "width and height of that texture",
                              .when = Change::precompute,
                              .unit = "texels"});
    visit(PARAM(stage), {.cite = "Sec. 4",
                         .doc = "search in the fragment stage, or most of the way in the vertex stage as in the paper",
                         .when = Change::program,
                         .choices = "fragment|split"});
    visit(PARAM(vertex_iterations),
          {.range = {1, 4096}, .cite = "Sec. 4", .doc = "bound on the steps of the vertex stage, if split"});
    visit(PARAM(transfer),
          {.symbol = "T_τ",
           .cite = "Sec. 3.3",
           .doc = "what stands for the transmission of a scattering medium: nothing (only absorption acts), "
                  "the paper's Gaussian and constant, these with the unscattered part apart, or two "
                  "Gaussians",
           .when = Change::precompute,
           .choices = kTransfers});
    visit(PARAM(face_size),
          {.symbol = "n",
           .range = {64, 1024},
           .cite = "Sec. 3.2",
           .doc = "width and height of a face that the blurred environments start from, a power of two",
           .when = Change::precompute,
           .unit = "texels"});
    visit(PARAM(omega),
          {.symbol = "ω",
           .range = {0.001, 0.5},
           .cite = "Sec. 3.2",
           .doc = "error that a blurred environment's texels may make, of a Gaussian's height: less means "
                  "wider key maps",
           .when = Change::precompute});
    visit(PARAM(key_filter), {.cite = "Sec. 3.1",
                              .doc = "filter environments on the sphere, or as the paper does by three flat maps",
                              .when = Change::precompute,
                              .choices = scattering::kSphereFilters});
    visit(PARAM(widening),
          {.range = {0.25, 4},
           .cite = "beyond the paper",
           .doc = "factor of the blur's width: the slab has no interface, at which a flat body of index "
                  "η spreads angles by η",
           .when = Change::precompute});
    visit(PARAM(show), {.cite = "Fig. 1c; beyond the paper",
                        .doc = "the picture, or of the first search: its steps over their bound, the way's length over "
                               "the diagonal, where the bound stopped it, the last cube, and where light is totally "
                               "reflected inside",
                        .choices = "radiance|steps|length|bounded|cube|internal_reflection"});
  }
};
static_assert(well_formed<Parameters>());

const ParameterTable& table();
std::unique_ptr<Technique> make();

}  // namespace pellucid::geocube
