#include <algorithm>
#include <cassert>
#include <cctype>
#include <map>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "sweeps/store/csv.hpp"
#include "sweeps/tables/tables.hpp"

namespace pellucid::sweeps {
namespace {

/// Code points of UTF-8 text.
std::size_t columns(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string padded(const std::string& text, std::size_t width, bool right) {
  const std::string space(width - std::min(width, columns(text)), ' ');
  return right ? space + text : text + space;
}

std::string escape_markdown(std::string_view text) {
  const auto in_word = [&](std::size_t i) {
    return i > 0 && i + 1 < text.size() && std::isalnum(static_cast<unsigned char>(text[i - 1])) != 0 &&
           std::isalnum(static_cast<unsigned char>(text[i + 1])) != 0;
  };
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool special = std::string_view("\\|*_`<>[]").find(c) != std::string_view::npos;
    if (special && !(c == '_' && in_word(i))) out += '\\';
    out += c == '\n' || c == '\r' ? ' ' : c;
  }
  return out;
}

std::string markdown(const Table& table) {
  std::vector<std::vector<std::string>> lines;
  for (const TableRow& row : table.rows) {
    if ((row.in & TableRow::markdown) == 0) continue;
    std::vector<std::string>& line = lines.emplace_back();
    line.push_back(escape_markdown(row.label));
    for (const TableCell& cell : row.cells)
      line.push_back(escape_markdown(cell.text));
  }
  std::vector<std::size_t> widths(lines.front().size(), 3);
  for (const auto& line : lines) {
    assert(line.size() == widths.size());
    for (std::size_t i = 0; i < line.size(); ++i)
      widths[i] = std::max(widths[i], columns(line[i]));
  }
  std::string out =
      fmt::format("**{}** ({})\n\n", escape_markdown(table.info.title), escape_markdown(table.info.source));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t k = 0; k < widths.size(); ++k)
      out += fmt::format("| {} ", padded(lines[i][k], widths[k], k > 0));
    out += "|\n";
    if (i > 0) continue;
    for (std::size_t k = 0; k < widths.size(); ++k)
      out += k == 0 ? fmt::format("|:{}-", std::string(widths[k], '-'))
                    : fmt::format("|-{}:", std::string(widths[k], '-'));
    out += "|\n";
  }
  if (!table.notes.empty()) out += "\n";
  for (const std::string& note : table.notes)
    out += fmt::format("- {}\n", escape_markdown(note));
  return out;
}

std::string csv(const Table& table) {
  std::string out;
  for (const TableRow& row : table.rows) {
    if ((row.in & TableRow::csv) == 0) continue;
    std::vector<std::string> fields{row.label};
    for (const TableCell& cell : row.cells)
      fields.push_back(cell.value ? fmt::format("{}", *cell.value) : cell.text);
    out += csv_record(fields);
  }
  return out;
}

/// The next code point, with its bytes taken off the front of `text`; U+FFFD for a byte that begins none.
char32_t take_code_point(std::string_view& text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  const std::size_t length = first < 0x80            ? 1
                             : (first >> 5U) == 0x6  ? 2
                             : (first >> 4U) == 0xE  ? 3
                             : (first >> 3U) == 0x1E ? 4
                                                     : 0;
  bool good = length > 0 && length <= text.size();
  char32_t code = length == 1 ? first : length > 0 ? first & (0x7FU >> length) : 0;
  for (std::size_t i = 1; good && i < length; ++i) {
    good = (byte(i) & 0xC0U) == 0x80U;
    code = (code << 6U) | (byte(i) & 0x3FU);
  }
  text.remove_prefix(good ? length : 1);
  return good ? code : U'\uFFFD';
}

/// For text mode of any LaTeX engine with no package but booktabs. Characters that pdfLaTeX has no glyph for in its own
/// fonts stay readable by their number.
std::string escape_latex(std::string_view text) {
  static const std::map<char32_t, std::string> special{{U'&', R"(\&)"},
                                                       {U'%', R"(\%)"},
                                                       {U'$', R"(\$)"},
                                                       {U'#', R"(\#)"},
                                                       {U'_', R"(\_)"},
                                                       {U'{', R"(\{)"},
                                                       {U'}', R"(\})"},
                                                       {U'~', R"(\textasciitilde{})"},
                                                       {U'^', R"(\textasciicircum{})"},
                                                       {U'\\', R"(\textbackslash{})"},
                                                       {U'<', R"($<$)"},
                                                       {U'>', R"($>$)"},
                                                       {U'|', R"($|$)"},
                                                       {U'"', "''"},
                                                       {U'\n', " "},
                                                       {U'\r', " "},
                                                       {U'\t', " "},
                                                       {U'×', R"($\times$)"},
                                                       {U'±', R"($\pm$)"},
                                                       {U'·', R"($\cdot$)"},
                                                       {U'†', R"($^\dagger$)"},
                                                       {U'–', "--"},
                                                       {U'—', "---"},
                                                       {U'−', "$-$"},
                                                       {U'…', R"(\dots{})"},
                                                       {U'≤', R"($\leq$)"},
                                                       {U'≥', R"($\geq$)"},
                                                       {U'→', R"($\rightarrow$)"},
                                                       {U'°', R"($^\circ$)"},
                                                       {U'²', "$^2$"},
                                                       {U'³', "$^3$"},
                                                       {U'µ', R"($\mu$)"},
                                                       {U'®', R"(\textregistered{})"},
                                                       {U'™', R"(\texttrademark{})"},
                                                       {U'‘', "`"},
                                                       {U'’', "'"},
                                                       {U'“', "``"},
                                                       {U'”', "''"},
                                                       {U'\u00A0', "~"}};
  std::string out;
  while (!text.empty()) {
    const std::string_view before = text;
    const char32_t code = take_code_point(text);
    if (const auto found = special.find(code); found != special.end()) {
      out += found->second;
    } else if ((code >= 0x20 && code < 0x7F) || (code >= 0xC0 && code < 0x180)) {
      out += before.substr(0, before.size() - text.size());
    } else {
      out += fmt::format("[U+{:04X}]", static_cast<unsigned>(code));
    }
  }
  return out;
}

std::string latex(const Table& table) {
  const std::size_t count = table.rows.front().cells.size();
  std::string out = fmt::format(
      "% {} of Pellucid; needs \\usepackage{{booktabs}}\n"
      "\\begin{{table}}\n  \\centering\n  \\caption{{{} ({}).}}\n  \\label{{tab:{}}}\n  "
      "\\small\\setlength{{\\tabcolsep}}{{3pt}}\n  \\begin{{tabular}}{{l{}}}\n"
      "    \\toprule\n",
      table.info.name, escape_latex(table.info.title), escape_latex(table.info.source), table.info.name,
      std::string(count, 'r'));
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const TableRow& row = table.rows[i];
    if (i == table.heading_rows) out += "    \\midrule\n";
    if ((row.in & TableRow::latex) == 0) continue;
    // After a line's end, a bracket or a star would be read as an argument of it.
    const bool argument = row.label.starts_with('[') || row.label.starts_with('*');
    out += fmt::format("    {}{}", argument ? "{}" : "", escape_latex(row.label));
    for (const TableCell& cell : row.cells)
      out += fmt::format(" & {}", escape_latex(cell.text));
    out += " \\\\\n";
  }
  out += "    \\bottomrule\n  \\end{tabular}\n";
  if (!table.notes.empty()) {
    out += "  \\par\\smallskip\n  \\begin{minipage}{0.95\\linewidth}\n    \\footnotesize\\raggedright\n";
    for (const std::string& note : table.notes)
      out += fmt::format("    {}\\par\n", escape_latex(note));
    out += "  \\end{minipage}\n";
  }
  return out + "\\end{table}\n";
}

std::string json_list(const Table& table) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const TableRecord& record : table.records) {
    nlohmann::ordered_json& entry = list.emplace_back(nlohmann::ordered_json::object());
    for (const auto& [name, value] : record) {
      if (value) {
        std::visit([&](const auto& v) { entry[name] = v; }, *value);
      } else {
        entry[name] = nullptr;
      }
    }
  }
  return list.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace

TableFormat parse_table_format(std::string_view name) {
  if (name == "md") return TableFormat::markdown;
  if (name == "csv") return TableFormat::csv;
  if (name == "latex") return TableFormat::latex;
  if (name == "json") return TableFormat::json;
  throw InputError(fmt::format("unknown format '{}'; a table comes as md, csv, latex or json", name));
}

std::string format_table(const Table& table, TableFormat format) {
  assert(!table.rows.empty());
  switch (format) {
    case TableFormat::markdown:
      return markdown(table);
    case TableFormat::csv:
      return csv(table);
    case TableFormat::latex:
      return latex(table);
    case TableFormat::json:
      break;
  }
  return json_list(table);
}

}  // namespace pellucid::sweeps
