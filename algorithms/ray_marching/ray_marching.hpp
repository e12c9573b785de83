#pragma once

#include <memory>

#include "algorithms/technique.hpp"

/// Volume ray casting in one pass (Kruger and Westermann 2003, references.bib: kruger2003), a peer of sampling hulls
/// beyond the paper; with interleaved sampling (Keller and Heidrich 2001, references.bib: keller2001), which Imagire et
/// al. 2007 discuss in Sec. 2.2.
namespace pellucid::ray_marching {

enum class Jitter { none, interleaved };

struct Parameters {
  int samples = 32;
  float sample_offset = 0.5F;
  Jitter jitter = Jitter::none;
  int tile = 4;
  bool filter_occlusion = true;

  static constexpr void parameters(auto& self, auto&& visit) {
    visit(PARAM(samples), {.symbol = "N",
                           .range = {1, 4096},
                           .cite = "Kruger and Westermann 2003, Sec. 3",
                           .doc = "points on the path through the volume"});
    visit(PARAM(sample_offset),
          {.range = {0, 1},
           .cite = "beyond the paper",
           .doc = "place of a point in its step without jitter: 0 at the back, 0.5 in the middle"});
    visit(PARAM(jitter), {.cite = "Keller and Heidrich 2001, Sec. 3",
                          .doc = "place of the points: the same in every pixel, or its own in each pixel of a tile",
                          .when = Change::program,
                          .choices = "none|interleaved"});
    visit(PARAM(tile), {.range = {2, 8},
                        .cite = "Keller and Heidrich 2001, Sec. 3",
                        .doc = "pixels along a side of the tile in which no two have the same place",
                        .when = Change::program,
                        .unit = "px"});
    visit(PARAM(filter_occlusion), {.cite = "Imagire et al. 2007, Eq. 3, 4",
                                    .doc = "average each light's occlusion rate with those at the two half-way points",
                                    .when = Change::program});
  }
};
static_assert(well_formed<Parameters>());

const ParameterTable& table();
std::unique_ptr<Technique> make();

}  // namespace pellucid::ray_marching
