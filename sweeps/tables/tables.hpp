#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "algorithms/parameters.hpp"
#include "sweeps/papers/paper.hpp"

/// Tables of papers in the papers' own form: the published numbers and what to show are data ([tables.NAME] of a
/// paper's file, grammar in sweeps/README.md), ours come from the rows of a store.
namespace pellucid::sweeps {

struct TableInfo {
  std::string name;       ///< "PAPER.table1"
  std::string address;    ///< what the command line calls it: the name, or "my.toml:table1"
  std::string title;      ///< the caption
  std::string source;     ///< paper and table of the published numbers
  std::string spec;       ///< the sweep that measures ours; SPEC_preview does so in less time
  std::string spec_path;  ///< what `pellucid sweep run` takes for it: the same name, or the file
};

/// Every table of the built-in papers.
std::vector<TableInfo> tables();

/// "PAPER.NAME", "NAME" where one paper alone has such a table, or "FILE.toml:NAME". Throws InputError with the nearest
/// name when there is none.
TableInfo find_table(std::string_view name);
TableInfo find_table(const PaperEntry&);

/// One cell of a table. `value` is what a program should read, `text` what is set for people: rounded, and with a
/// dagger where the frame time did not converge.
struct TableCell {
  std::string text;             ///< empty when there is nothing to say
  std::optional<double> value;  ///< of a number
};

struct TableRow {
  /// Where it stands: what is one row for the eye may be two for a narrow page or a program.
  enum In : unsigned { markdown = 1, latex = 2, csv = 4, all = 7 };
  std::string label;
  std::vector<TableCell> cells;     ///< one for each column of the published table
  unsigned in = all;                ///< an or of In
  Better better = Better::neither;  ///< of measured values: which of them is the best
};

/// One measurement of a table for JSON, in the order of its fields: `paper` (published value or nothing) and `ours`
/// always among them.
using TableRecord = std::vector<std::pair<std::string, std::optional<Value>>>;

struct Table {
  TableInfo info;
  std::vector<TableRow> rows;        ///< all have equally many cells
  std::size_t heading_rows = 1;      ///< so many of the first name the columns
  std::vector<TableRecord> records;  ///< one for each column
  std::vector<std::string> notes;    ///< whose numbers these are, and what to mind
  std::string sweep;                 ///< the sweep that ours are from; empty when there is none of ours
};

/// Fills a table from `rows` (sweeps/store/store.hpp) of its sweep or, when there are none, of the sweep's preview;
/// other rows are left alone. Points that are missing stay empty, failed ones say so, and the notes count both.
/// `device`: take the rows whose "DEVICE, DRIVER" contains this; empty: rows must be of one device and driver. Throws
/// InputError for an unknown name (with the nearest), for rows of several devices or drivers (they are named), and for
/// two rows that claim the same place.
Table make_table(std::string_view name, const std::vector<nlohmann::json>& rows, std::string_view device = "");
Table make_table(const PaperEntry&, const std::vector<nlohmann::json>& rows, std::string_view device = "");

enum class TableFormat { markdown, csv, latex, json };
/// "md", "csv", "latex", "json". Throws InputError with these names.
TableFormat parse_table_format(std::string_view name);

struct LatexOptions {
  bool siunitx = false;    ///< columns that align numbers at the decimal point
  bool bold_best = false;  ///< the best measured value of each row whose quantity says which way is better
};

/// markdown: aligned, notes below. csv: RFC 4180, numbers in full, no notes. latex: a booktabs table with caption and
/// notes. json: a list of the records. Ends with a newline.
std::string format_table(const Table&, TableFormat, const LatexOptions& = {});
/// See format_table.
std::string format_latex(const Table&, const LatexOptions&);

}  // namespace pellucid::sweeps
