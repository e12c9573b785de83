#pragma once

#include <memory>

#include "algorithms/technique.hpp"

/// Slice-based volume rendering (Cullip and Neumann 1994, references.bib: cullip1994), with image- or object-aligned
/// slices: the baseline of Imagire et al. 2007.
namespace pellucid::volume_slices {

enum class Alignment { image, object };

struct Parameters {
  int slices = 32;
  Alignment alignment = Alignment::image;

  static constexpr void parameters(auto& self, auto&& visit) {
    visit(PARAM(slices),
          {.range = {1, 4096}, .cite = "Imagire et al. 2007, Sec. 2.1", .doc = "slice planes through the volume"});
    visit(PARAM(alignment),
          {.cite = "Imagire et al. 2007, Sec. 2.1",
           .doc = "planes parallel to the screen, or across the box's axis nearest to the viewing axis",
           .choices = "image|object"});
  }
};
static_assert(well_formed<Parameters>());

const ParameterTable& table();
std::unique_ptr<Technique> make();

}  // namespace pellucid::volume_slices
