// Tables for LaTeX.
#include <algorithm>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "sweeps/tables/tables.hpp"

namespace pellucid::sweeps {
namespace {

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

/// Cells that equal the best measured value as it is printed.
std::vector<bool> best_cells(const TableRow& row) {
  std::vector<bool> best(row.cells.size(), false);
  if (row.better == Better::neither) return best;
  const TableCell* found = nullptr;
  for (const TableCell& cell : row.cells) {
    if (!cell.value) continue;
    if (found == nullptr || (row.better == Better::less ? *cell.value < *found->value : *cell.value > *found->value))
      found = &cell;
  }
  for (std::size_t i = 0; found != nullptr && i < row.cells.size(); ++i)
    best[i] = row.cells[i].value && row.cells[i].text == found->text;
  return best;
}

/// Whether siunitx can align it: digits with a sign, a point, an exponent.
bool is_number(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789.-+e") == std::string_view::npos &&
         text.find_first_of("0123456789") != std::string_view::npos;
}

std::string cell_text(const TableCell& cell, bool best, bool siunitx, bool heading) {
  const std::string text = escape_latex(cell.text);
  if (siunitx && !heading && is_number(cell.text)) return best ? "\\bfseries " + text : text;
  const std::string shown = best ? fmt::format("\\textbf{{{}}}", text) : text;
  return siunitx && !shown.empty() ? fmt::format("{{{}}}", shown) : shown;
}

/// A column of siunitx that has room for its longest number: "S[table-format=3.2, detect-weight]".
std::string number_column(const Table& table, std::size_t column) {
  std::size_t whole = 1, decimals = 0;
  for (const TableRow& row : table.rows) {
    const std::string& text = row.cells[column].text;
    if ((row.in & TableRow::latex) == 0 || !is_number(text) || text.find('e') != std::string::npos) continue;
    const std::size_t point = std::min(text.find('.'), text.size());
    whole = std::max(whole, point - (text.front() == '-' ? 1 : 0));
    decimals = std::max(decimals, text.size() - std::min(point + 1, text.size()));
  }
  return fmt::format("S[table-format={}.{}, detect-weight]", whole, decimals);
}

std::string columns_text(const Table& table, const LatexOptions& options) {
  const std::size_t count = table.rows.front().cells.size();
  if (!options.siunitx) return std::string("l").append(count, 'r');
  std::string text = "l";
  for (std::size_t i = 0; i < count; ++i)
    text += "\n    " + number_column(table, i);
  return text;
}

}  // namespace

std::string format_latex(const Table& table, const LatexOptions& options) {
  std::string out = fmt::format(
      "% {} of Pellucid; needs \\usepackage{{booktabs}}{}\n"
      "\\begin{{table}}\n  \\centering\n  \\caption{{{} ({}).}}\n  \\label{{tab:{}}}\n  "
      "\\small\\setlength{{\\tabcolsep}}{{3pt}}\n  \\begin{{tabular}}{{{}}}\n"
      "    \\toprule\n",
      table.info.name, options.siunitx ? " and \\usepackage{siunitx}" : "", escape_latex(table.info.title),
      escape_latex(table.info.source), table.info.name, columns_text(table, options));
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const TableRow& row = table.rows[i];
    if (i == table.heading_rows) out += "    \\midrule\n";
    if ((row.in & TableRow::latex) == 0) continue;
    // After a line's end, a bracket or a star would be read as an argument of it.
    const bool argument = row.label.starts_with('[') || row.label.starts_with('*');
    out += fmt::format("    {}{}", argument ? "{}" : "", escape_latex(row.label));
    const std::vector<bool> best = options.bold_best ? best_cells(row) : std::vector<bool>(row.cells.size(), false);
    for (std::size_t k = 0; k < row.cells.size(); ++k)
      out += fmt::format(" & {}", cell_text(row.cells[k], best[k], options.siunitx, i < table.heading_rows));
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

}  // namespace pellucid::sweeps
