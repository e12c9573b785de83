#pragma once

#include <string>

#include "plots/figures/figures.hpp"
#include "plots/figures/rows.hpp"

/// Figures of Imagire et al. 2007 (references.bib: imagire2007) over the plane of hulls M and samples N.
namespace pellucid::plots {

/// The SVG of `field` ("fps" or "flip_mean") on the plane of M and N. Two cells are marked: the paper's choice, 4×8,
/// and ours, the fastest setting whose mean FLIP is no larger than that of the paper's choice, where rows tell both.
/// Throws InputError when the rows have more than one setting beside M and N.
std::string plane_map(const FigureInfo&, const Rows&, const std::string& field);

}  // namespace pellucid::plots
