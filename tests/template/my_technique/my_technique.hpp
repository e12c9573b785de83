#pragma once

#include <memory>

#include "algorithms/technique.hpp"

/// A tint over the opaque picture: the smallest technique that has a parameter of each kind of change, a shader and a
/// pass of its own. First line of a real one: what it does, its paper and the key in references.bib.
namespace pellucid::my_technique {

struct Parameters {
  float strength = 0.5F;
  bool inverted = false;

  static constexpr void parameters(auto& self, auto&& visit) {
    visit(PARAM(strength),
          {.symbol = "s", .range = {0, 1}, .cite = "Sec. 1, Eq. 1", .doc = "share of the tint in a pixel"});
    visit(PARAM(inverted), {.cite = "Sec. 1", .doc = "tint with the complement", .when = Change::program});
  }
};
static_assert(well_formed<Parameters>());

const ParameterTable& table();
std::unique_ptr<Technique> make();

}  // namespace pellucid::my_technique
