#pragma once

#include <vector>

#include "plots/figures/figures.hpp"
#include "plots/figures/row_chart.hpp"

/// Named figures that are plain charts of two fields of their spec's rows: data, no code.
namespace pellucid::plots {

struct RowFigure {
  FigureInfo info;
  RowChart chart;  ///< `title` and the sweep's condition come from `info`
};

/// In the order of the papers.
const std::vector<RowFigure>& row_figures();

}  // namespace pellucid::plots
