#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "plots/figures/figures.hpp"
#include "plots/figures/rows.hpp"

/// Figures of Imagire et al. 2007 (references.bib: imagire2007, Sec. 3.3) over the size of the shadow maps.
namespace pellucid::plots {

/// The SVG of `field` over shadow.size, a line for each technique with averaged occlusion rates and without, from the
/// blocks FIGURE_hulls, FIGURE_marching and FIGURE_slices of the rows that meet the conditions.
std::string shadow_size_figure(const FigureInfo&, const std::vector<nlohmann::json>& rows,
                               const std::vector<Condition>&, const std::string& figure, const std::string& field);

}  // namespace pellucid::plots
