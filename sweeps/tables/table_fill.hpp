#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "sweeps/store/rows.hpp"
#include "sweeps/tables/table_spec.hpp"

/// From a table's description and the rows of a store to its places. For the tables' own files.
namespace pellucid::sweeps {

/// A column in a group, or a family in it, and the row of the store that fills it.
struct TablePlace {
  std::string name;                     ///< in notes: "4 × 8 (in a corner)"
  const nlohmann::json* row = nullptr;  ///< null: not measured
  std::string outcome;                  ///< see outcome()

  bool measured() const { return row != nullptr && outcome != "failed"; }
};

/// A line's cells in one group: what the paper says and what was measured, by column.
struct FilledLine {
  const TableLine* line = nullptr;
  std::string label;  ///< without " (paper)" or " (ours)"
  const Quantity* quantity = nullptr;
  std::vector<TableCell> paper;  ///< empty when it says nothing
  std::vector<TableCell> ours;
  std::vector<TableCell> low, high;  ///< of the interval; empty when the line shows none
};

struct FilledGroup {
  std::string name;
  Variables variables;
  std::vector<TablePlace> places;  ///< by column
  RowPointers used;                ///< every row that fills a place, the families' too
  std::vector<FilledLine> lines;
};

/// Throws InputError when two rows claim one place.
std::vector<FilledGroup> fill_groups(const TableSpec&, const SweepRows&);

/// For JSON: of every group and column, one record for each of the description's `records`.
std::vector<TableRecord> make_records(const TableSpec&, const std::vector<FilledGroup>&, const std::string& sweep);

/// Rows for the eye, group by group or transposed.
std::vector<TableRow> lay_out(const TableSpec&, const std::vector<FilledGroup>&);

/// Whose the published numbers are, where ours come from, and what is unconverged, failed, untimed or missing.
std::vector<std::string> make_notes(const TableSpec&, const std::vector<FilledGroup>&, const std::string& sweep);

}  // namespace pellucid::sweeps
