#pragma once

#include <memory>

#include "algorithms/technique.hpp"

/// Slice-based volume rendering with image-aligned slices (Cullip and Neumann 1994, references.bib: cullip1994): the
/// baseline of Imagire et al. 2007.
namespace pellucid::volume_slices {

struct Parameters {
  int slices = 32;

  static constexpr void parameters(auto& self, auto&& visit) {
    visit(PARAM(slices), {.range = {1, 4096},
                          .cite = "Imagire et al. 2007, Sec. 2.1",
                          .doc = "image-aligned slice planes through the volume"});
  }
};
static_assert(well_formed<Parameters>());

const ParameterTable& table();
std::unique_ptr<Technique> make();

}  // namespace pellucid::volume_slices
