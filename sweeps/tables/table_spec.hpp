#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sweeps/papers/paper.hpp"
#include "sweeps/tables/table_variables.hpp"
#include "sweeps/tables/tables.hpp"

/// A table as the file of a paper describes it ([tables.NAME]; grammar: sweeps/README.md), read and checked in full
/// before a row is looked at. For the tables' own files.
namespace pellucid::sweeps {

/// A column, a group or a family: which of the sweep's rows it takes, and what its texts may name.
struct TableEntry {
  std::string name;  ///< a template
  FilePosition at;
  std::vector<std::pair<std::string, std::vector<Value>>> where;  ///< a field and the values it may have
  Variables variables;                                            ///< `with`, and the fields that have one value
};

/// Stands in a file for a value that does not exist.
inline constexpr std::string_view kNone = "none";

/// The paper's own value in one place.
struct Published {
  std::optional<double> low, high;  ///< the same where it is one number
  bool is_range() const { return low != high; }
  std::optional<double> value() const { return is_range() ? std::nullopt : low; }
};

struct TableLine {
  enum class Kind {
    show,      ///< what the columns are: a text with their variables
    quantity,  ///< a measurement
    outcome    ///< "converged", …: for CSV
  };
  Kind kind = Kind::quantity;
  FilePosition at;
  std::string label;          ///< a template; empty: the quantity's heading
  std::string show;           ///< a template, or a variable's name
  std::string quantity;       ///< a name, or a template of one
  std::string family;         ///< whose rows; empty: the table's
  std::string over;           ///< the family that the value is divided by; empty: none
  std::string id;             ///< how `json` and `records` call it
  std::string json_quantity;  ///< a template: what a record says under "quantity"; empty: the quantity's name
  std::vector<std::vector<Published>> published;        ///< for each group, or for all, by column; empty: none
  std::vector<std::optional<std::size_t>> relative_to;  ///< by column; empty: it is not relative
  std::optional<int> digits, decimals;
  bool interval = false, optional = false;

  bool is_ratio() const { return !over.empty() || !relative_to.empty(); }
};

/// A field of a record for JSON: `source` is a variable, a line's id, a quantity, "name", "group", "result" or "none".
struct RecordField {
  std::string name, source;
};

struct TableSpec {
  PaperEntry entry;
  TableInfo info;
  std::string paper_note;  ///< whose numbers the published ones are; empty: none
  std::vector<std::string> notes;
  TableEntry all;  ///< `where` and `with` of the whole table
  std::vector<TableEntry> columns;
  std::vector<TableEntry> groups;  ///< one without a name when the file has none
  bool grouped = false, skip_empty_groups = false;
  std::map<std::string, TableEntry, std::less<>> families;
  std::string family;  ///< of lines that name none; empty: the columns as they are
  std::string label;   ///< template of a line's label in a group, of {row} and {group}
  std::string corner;  ///< of a transposed table
  bool transposed = false;
  std::size_t heading_rows = 1;
  std::vector<TableLine> lines;
  std::vector<RecordField> json;
  std::vector<std::string> records;  ///< ids of lines: one record each, for every column

  const TableLine* find_line(std::string_view id) const;
};

/// Throws InputError "file:line:column: …".
TableSpec read_table_spec(const PaperEntry&);

}  // namespace pellucid::sweeps
