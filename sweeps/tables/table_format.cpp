#include <algorithm>
#include <cassert>
#include <cctype>
#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "sweeps/tables/csv.hpp"
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

std::string json_list(const Table& table) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const TableRecord& record : table.records) {
    nlohmann::ordered_json& entry = list.emplace_back(nlohmann::ordered_json::object());
    for (const auto& [name, value] : record) {
      if (value) {
        std::visit([&, &name = name](const auto& v) { entry[name] = v; }, *value);
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

std::string format_table(const Table& table, TableFormat format, const LatexOptions& latex) {
  assert(!table.rows.empty());
  switch (format) {
    case TableFormat::markdown:
      return markdown(table);
    case TableFormat::csv:
      return csv(table);
    case TableFormat::latex:
      return format_latex(table, latex);
    case TableFormat::json:
      break;
  }
  return json_list(table);
}

}  // namespace pellucid::sweeps
