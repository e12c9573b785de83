#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "sweeps/tables/tables.hpp"

namespace pellucid::sweeps::test {

inline const TableRow& row_of(const Table& table, const std::string& label) {
  std::string labels;
  for (const TableRow& row : table.rows) {
    if (row.label == label) return row;
    labels += "'" + row.label + "' ";
  }
  throw std::runtime_error("no row " + label + " among " + labels);
}

/// The row's cells as a person reads them.
inline std::vector<std::string> texts(const Table& table, const std::string& label) {
  std::vector<std::string> result;
  for (const TableCell& cell : row_of(table, label).cells)
    result.push_back(cell.text);
  return result;
}

inline bool noted(const Table& table, const std::string& part) {
  return std::any_of(table.notes.begin(), table.notes.end(),
                     [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

}  // namespace pellucid::sweeps::test
