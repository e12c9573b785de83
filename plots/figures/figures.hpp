#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "plots/figures/rows.hpp"

/// Figures by name, drawn from rows of a store (sweeps/store/store.hpp).
namespace pellucid::plots {

struct FigureInfo {
  std::string name;   ///< "sampling_hulls.fps"
  std::string title;  ///< printed above the chart
  std::string doc;    ///< one sentence: what is drawn
  std::string spec;   ///< the built-in spec that measures its rows
};

/// Every named figure, in the order of the papers.
std::vector<FigureInfo> figures();

/// Throws InputError with the nearest name when there is no such figure.
FigureInfo find_figure(std::string_view name);

/// Draws a named figure to `path` (.svg, .png or .pdf by extension; whole or not at all). It takes the rows of its own
/// spec, else of that spec's preview, else every row it can use, unless `conditions` name a sweep; they choose further.
/// Failed rows are left out and counted in the chart's note.
/// Throws InputError for an unknown name (nearest one suggested) or extension, for rows of more than one device or
/// driver (they are named) and when nothing is left to draw; RuntimeError when the file cannot be written or
/// rsvg-convert is missing (PNG and PDF).
void write_figure(std::string_view name, const std::vector<nlohmann::json>& rows, const std::filesystem::path& path,
                  std::span<const Condition> conditions = {});

}  // namespace pellucid::plots
