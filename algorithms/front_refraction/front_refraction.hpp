#pragma once

#include <memory>

#include "algorithms/technique.hpp"

/// Refraction where the eye's ray enters an object and nowhere else, as most shaders had it: the baseline of Chan and
/// Wang 2005, Fig. 1a (references.bib: chan2005). The refracted ray looks up the environment at once; it has no length,
/// so that nothing is absorbed.
namespace pellucid::front_refraction {

struct Parameters {
  bool reflection = true;

  static constexpr void parameters(auto& self, auto&& visit) {
    visit(PARAM(reflection), {.cite = "Fig. 1a",
                              .doc = "add the environment that the front side reflects; its share is taken off the "
                                     "refracted light either way"});
  }
};
static_assert(well_formed<Parameters>());

const ParameterTable& table();
std::unique_ptr<Technique> make();

}  // namespace pellucid::front_refraction
