// A filled table as rows for the eye and for CSV.
#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "sweeps/tables/table_fill.hpp"

namespace pellucid::sweeps {
namespace {

bool any_text(const std::vector<TableCell>& cells) {
  return std::any_of(cells.begin(), cells.end(), [](const TableCell& cell) { return !cell.text.empty(); });
}

std::string label_in_group(const TableSpec& spec, const FilledGroup& group, const std::string& row) {
  if (group.name.empty()) return row;
  Variables variables = group.variables;
  variables["group"] = group.name;
  variables["row"] = row;
  return expand(spec.label, variables);
}

/// One row for a page, two for programs.
void add_interval(const FilledLine& line, const TableSpec& spec, const FilledGroup& group,
                  std::vector<TableRow>& rows) {
  const std::string label = line.quantity->interval.substr(0, line.quantity->interval.find(" of the median"));
  const auto named = [&](const char* end) { return label_in_group(spec, group, label + end); };
  TableRow both{named(""), line.low, TableRow::markdown};
  for (std::size_t i = 0; i < both.cells.size(); ++i) {
    if (line.low[i].value && line.high[i].value) both.cells[i].text += "–" + line.high[i].text;
    both.cells[i].value.reset();
  }
  rows.push_back(std::move(both));
  rows.push_back({named(", low"), line.low, TableRow::latex | TableRow::csv});
  rows.push_back({named(", high"), line.high, TableRow::latex | TableRow::csv});
}

/// A line of a group as rows. `group`'s name goes into the label.
void add_line(const FilledLine& line, const TableSpec& spec, const FilledGroup& group, std::vector<TableRow>& rows) {
  if (line.line->kind == TableLine::Kind::show) {
    rows.push_back({line.label, line.ours, TableRow::all});
    return;
  }
  if (line.line->kind == TableLine::Kind::outcome) {
    rows.push_back({label_in_group(spec, group, line.label), line.ours, TableRow::csv});
    return;
  }
  if (line.line->optional && !any_text(line.ours) && !any_text(line.paper)) return;
  if (!line.paper.empty())
    rows.push_back({label_in_group(spec, group, line.label + " (paper)"), line.paper, TableRow::all});
  const std::string ours = line.line->published.empty() && line.paper.empty() ? line.label : line.label + " (ours)";
  TableRow row{label_in_group(spec, group, ours), line.ours, TableRow::all};
  row.better = line.quantity->better;
  rows.push_back(std::move(row));
  if (!line.low.empty()) add_interval(line, spec, group, rows);
}

/// Columns become rows: the lines' labels head them.
std::vector<TableRow> transposed(const TableSpec& spec, const std::vector<FilledGroup>& groups) {
  std::vector<TableRow> out{{spec.corner, {}, TableRow::all}};
  for (const FilledGroup& group : groups) {
    std::vector<TableRow> lines;
    FilledGroup nameless = group;
    nameless.name.clear();
    for (const FilledLine& line : group.lines)
      add_line(line, spec, nameless, lines);
    std::erase_if(lines, [](const TableRow& row) {
      return row.in != TableRow::all && row.in != (TableRow::latex | TableRow::csv);
    });
    if (out.front().cells.empty()) {
      for (const TableRow& line : lines)
        out.front().cells.push_back({line.label, std::nullopt});
    }
    for (std::size_t i = 0; i < spec.columns.size(); ++i) {
      const TableEntry& column = spec.columns[i];
      TableRow row{label_in_group(spec, group, expand(column.name, merged(group.variables, column.variables))),
                   {},
                   TableRow::all};
      for (TableRow& line : lines)
        row.cells.push_back(std::move(line.cells[i]));
      out.push_back(std::move(row));
    }
  }
  return out;
}

}  // namespace

std::vector<TableRow> lay_out(const TableSpec& spec, const std::vector<FilledGroup>& groups) {
  if (spec.transposed) return transposed(spec, groups);
  std::vector<TableRow> rows;
  for (const FilledGroup& group : groups) {
    for (const FilledLine& line : group.lines) {
      // The columns' own names stand once, above all groups.
      if (line.line->kind == TableLine::Kind::show && &group != &groups.front()) continue;
      add_line(line, spec, group, rows);
    }
  }
  return rows;
}

}  // namespace pellucid::sweeps
