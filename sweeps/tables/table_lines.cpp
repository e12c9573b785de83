// The rows of a table, as the file gives them.
#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "gl/error.hpp"
#include "sweeps/tables/table_entries.hpp"

namespace pellucid::sweeps {
namespace {

/// "none", 105, or "105..130".
Published read_published(const TableReader& reader, const toml::node& node) {
  const auto fail = [&]() {
    reader.fail(place_of(node),
                fmt::format("{}.paper: a published value is a number, \"105..130\" or \"none\"", reader.path()));
  };
  if (const auto number = node.value<double>(); number && node.is_number()) return {*number, *number};
  const auto text = node.value<std::string>();
  if (!text) fail();
  if (*text == kNone) return {};
  const std::size_t dots = text->find("..");
  if (dots == std::string::npos) fail();
  const auto number = [&](std::string_view part) {
    double value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error != std::errc{} || end != part.data() + part.size()) fail();
    return value;
  };
  const Published range{number(std::string_view(*text).substr(0, dots)),
                        number(std::string_view(*text).substr(dots + 2))};
  if (*range.low > *range.high) fail();
  return range;
}

const toml::array& list_of(const TableReader& reader, const toml::node& node, std::string_view key, std::size_t count,
                           std::string_view of) {
  const toml::array* list = node.as_array();
  if (list == nullptr || list->size() != count) {
    reader.fail(place_of(node),
                fmt::format("{}.{}: a list of {} values, one for each {}", reader.path(), key, count, of));
  }
  return *list;
}

void read_published_rows(TableReader& reader, const TableSpec& spec, TableLine& line) {
  const toml::node* node = reader.node("paper");
  if (node == nullptr) return;
  const toml::array* outer = node->as_array();
  const bool by_group = outer != nullptr && !outer->empty() && outer->get(0)->is_array();
  const auto add = [&](const toml::node& values) {
    std::vector<Published>& row = line.published.emplace_back();
    for (const toml::node& value : list_of(reader, values, "paper", spec.columns.size(), "column"))
      row.push_back(read_published(reader, value));
  };
  if (!by_group) {
    add(*node);
    return;
  }
  for (const toml::node& group : list_of(reader, *node, "paper", spec.groups.size(), "group"))
    add(group);
}

/// A column by its position from 0, or by its name.
std::optional<std::size_t> read_column(const TableReader& reader, const toml::node& node, const TableSpec& spec) {
  std::vector<std::string> names;
  for (const TableEntry& column : spec.columns)
    names.push_back(expand(column.name, column.variables));
  if (const auto text = node.value<std::string>()) {
    if (*text == kNone) return std::nullopt;
    const auto found = std::find(names.begin(), names.end(), *text);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  } else if (const auto position = node.value<std::int64_t>(); position && node.is_integer()) {
    if (*position >= 0 && *position < static_cast<std::int64_t>(names.size()))
      return static_cast<std::size_t>(*position);
  }
  reader.fail(place_of(node), fmt::format("{}.relative_to: a column is one of '{}', or its position from 0 to {}",
                                          reader.path(), fmt::join(names, "', '"), names.size() - 1));
}

void read_relative_to(TableReader& reader, const TableSpec& spec, TableLine& line) {
  const toml::node* node = reader.node("relative_to");
  if (node == nullptr) return;
  if (!node->is_array()) {
    line.relative_to.assign(spec.columns.size(), read_column(reader, *node, spec));
    return;
  }
  for (const toml::node& column : list_of(reader, *node, "relative_to", spec.columns.size(), "column"))
    line.relative_to.push_back(read_column(reader, column, spec));
  if (line.label.empty()) reader.fail("relative_to", "a row relative to several columns needs a label");
}

void read_count(TableReader& reader, const char* key, double most, std::optional<int>& count) {
  double value = 0;
  reader.integer(key, value, {0, most});
  if (reader.has(key)) count = static_cast<int>(value);
}

}  // namespace

void read_family(TableReader& reader, const char* key, const TableSpec& spec, std::string& family) {
  reader.text(key, family);
  if (family.empty() || spec.families.contains(family)) return;
  std::vector<std::string> names;
  for (const auto& [name, entry] : spec.families)
    names.push_back(name);
  reader.fail(key, names.empty() ? "the table has no families"
                                 : fmt::format("'{}' is none of the families {}", family, fmt::join(names, ", ")));
}

namespace {

/// The quantities that a line shows, whatever group it stands in; throws for an unknown one.
void check_quantity(TableReader& reader, const TableSpec& spec, const TableLine& line) {
  for (const TableEntry& group : spec.groups) {
    try {
      const Quantity& quantity =
          spec.entry.paper->quantity(expand(line.quantity, merged(spec.all.variables, group.variables)));
      if (quantity.text) throw InputError(fmt::format("'{}' holds words; show it with show", quantity.name));
      if (line.interval && quantity.low.empty()) throw InputError(fmt::format("'{}' has no interval", quantity.name));
    } catch (const InputError& e) {
      reader.fail("quantity", e.what());
    }
  }
}

/// A row that shows a variable by its name needs a column that has it.
void check_shown(TableReader& reader, const TableSpec& spec, const std::string& show) {
  if (show == "name" || show.find('{') != std::string::npos) return;
  std::set<std::string> names{"name"};
  for (const TableEntry& column : spec.columns) {
    for (const auto& [name, value] : merged(spec.all.variables, column.variables))
      names.insert(name);
  }
  if (!names.contains(show))
    reader.fail("show", fmt::format("no column has '{}'{}", show, name_hint(show, {names.begin(), names.end()})));
}

TableLine read_line(TableReader& reader, const TableSpec& spec) {
  TableLine line;
  line.at = reader.place();
  reader.text("label", line.label);
  if (reader.has("show")) {
    line.kind = TableLine::Kind::show;
    reader.text("show", line.show, Need::required);
    check_shown(reader, spec, line.show);
    if (line.label.empty() && line.show.find('{') == std::string::npos) line.label = line.show;
    reader.finish();
    return line;
  }
  if (reader.has("outcome")) {
    line.kind = TableLine::Kind::outcome;
    bool wanted = true;
    reader.boolean("outcome", wanted);
    if (!wanted) reader.fail("outcome", "leave the row away instead");
    if (line.label.empty()) line.label = "outcome";
    reader.finish();
    return line;
  }
  reader.text("quantity", line.quantity, Need::required);
  read_family(reader, "family", spec, line.family);
  read_family(reader, "over", spec, line.over);
  reader.boolean("interval", line.interval);
  reader.boolean("optional", line.optional);
  read_count(reader, "digits", 17, line.digits);
  read_count(reader, "decimals", 17, line.decimals);
  read_published_rows(reader, spec, line);
  read_relative_to(reader, spec, line);
  reader.exclude("over", "relative_to");
  line.id = line.quantity;
  if (!line.family.empty()) line.id += "_" + line.family;
  if (!line.over.empty()) line.id += "_over_" + line.over;
  if (!line.relative_to.empty()) line.id += "_relative";
  reader.text("id", line.id);
  if (spec.find_line(line.id) != nullptr)
    reader.fail("id", fmt::format("'{}' names an earlier row; give one of them an id of its own", line.id));
  reader.text("json_quantity", line.json_quantity);
  check_quantity(reader, spec, line);
  if (line.is_ratio() && !line.decimals && !line.digits) line.decimals = 2;
  if (line.is_ratio() && line.interval) reader.fail("interval", "a ratio has no interval");
  reader.finish();
  return line;
}

}  // namespace

void read_lines(TableReader& reader, TableReader& root, TableSpec& spec) {
  for (TableReader& row : reader.tables("rows", Need::required)) {
    if (!row.has("set")) {
      spec.lines.push_back(read_line(row, spec));
      continue;
    }
    std::string name;
    row.text("set", name, Need::required);
    row.finish();
    auto sets = root.table("row_sets");
    if (!sets || !sets->has(name)) {
      const std::vector<std::string> names = sets ? sets->keys() : std::vector<std::string>();
      row.fail("set", fmt::format("[row_sets] has no '{}'{}", name, name_hint(name, names)));
    }
    for (TableReader& inner : sets->tables(name, Need::required)) {
      if (inner.has("set")) inner.fail("set", "a set of rows names no other set");
      spec.lines.push_back(read_line(inner, spec));
    }
  }
}

}  // namespace pellucid::sweeps
