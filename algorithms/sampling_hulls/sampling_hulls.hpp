#pragma once

#include <memory>

#include "algorithms/technique.hpp"

/// Imagire, Johan, Tamura, Nishita 2007 (references.bib: imagire2007).
namespace pellucid::sampling_hulls {

enum class Coordinates { automatic, unorm8, single };

struct Parameters {
  int hulls = 4;
  int samples = 8;
  float sample_offset = 0.0F;
  Coordinates coordinates = Coordinates::automatic;
  bool filter_occlusion = true;

  static constexpr void parameters(auto& self, auto&& visit) {
    visit(PARAM(hulls), {.symbol = "M", .range = {1, 64}, .cite = "Sec. 3.2", .doc = "sampling hulls per volume"});
    visit(PARAM(samples), {.symbol = "N",
                           .range = {1, 256},
                           .cite = "Eq. 1, 2",
                           .doc = "sampling points on the valid path of each hull",
                           .when = Change::program});
    visit(PARAM(sample_offset),
          {.range = {0, 1},
           .cite = "Eq. 1; beyond the paper where not 0",
           .doc = "place of a point in its step: 0 at the back as in the paper, 0.5 in the middle"});
    visit(PARAM(coordinates),
          {.cite = "Sec. 4",
           .doc = "format of the local-coordinates map; automatic is 8 bits below 256 voxels, else float",
           .when = Change::precompute,
           .choices = "automatic|unorm8|single"});
    visit(PARAM(filter_occlusion), {.cite = "Eq. 3, 4",
                                    .doc = "average each light's occlusion rate with those at the two half-way points",
                                    .when = Change::program});
  }
};
static_assert(well_formed<Parameters>());

const ParameterTable& table();
std::unique_ptr<Technique> make();

}  // namespace pellucid::sampling_hulls
