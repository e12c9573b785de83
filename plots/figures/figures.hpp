#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "plots/figures/plane_map.hpp"
#include "plots/figures/row_chart.hpp"
#include "plots/figures/rows.hpp"
#include "plots/figures/slab_chart.hpp"
#include "sweeps/papers/paper.hpp"

/// The figures of papers: [[figures]] of a paper's file (sweeps/README.md), drawn from rows of a store.
namespace pellucid::plots {

/// A figure as its paper declares it.
struct Figure {
  sweeps::PaperPointer paper;
  std::string name;       ///< within the paper: "fps"
  std::string full_name;  ///< "PAPER.fps"
  std::string title;      ///< printed above the chart
  std::string doc;        ///< one sentence: what is drawn
  std::string sweep;      ///< whose rows it shows; or those of its preview, SWEEP_preview; empty: it needs none
  std::variant<RowChart, PlaneMap, SlabChart> drawing;
};

/// Every figure of a paper, in the order of its file. Throws InputError "file:line:column: …" for the first mistake.
std::vector<Figure> read_figures(const sweeps::PaperPointer&);
/// Those of the built-in papers.
std::vector<Figure> built_in_figures();
/// "PAPER.NAME", "NAME" where one paper alone has it, or "FILE.toml:NAME". Throws InputError with the nearest name.
Figure find_figure(std::string_view name);

/// A drawing, and the numbers behind it.
struct Drawn {
  std::string svg;
  std::string csv;  ///< one record for each point or cell, with a heading
};
/// Draws a figure from the rows of its own sweep, else of that sweep's preview, else from every row it can use, unless
/// `where` names a sweep; `where` chooses further. Failed rows are left out and counted in the chart's note. Throws
/// InputError for rows of more than one device or driver (they are named) and when nothing is left to draw.
Drawn draw_figure(const Figure&, const std::vector<nlohmann::json>& rows, std::span<const Where> where = {});
/// A chart of any two fields.
Drawn draw_chart(const RowChart&, const std::vector<nlohmann::json>& rows);

}  // namespace pellucid::plots
