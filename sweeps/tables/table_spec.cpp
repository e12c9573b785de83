#include "sweeps/tables/table_spec.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "gl/error.hpp"
#include "sweeps/tables/table_entries.hpp"

namespace pellucid::sweeps {
namespace {

constexpr const char* kNone = "none";

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
}

void read_count(TableReader& reader, const char* key, double most, std::optional<int>& count) {
  if (!reader.has(key)) return;
  double value = 0;
  reader.integer(key, value, {0, most});
  count = static_cast<int>(value);
}

void read_family(TableReader& reader, const char* key, const TableSpec& spec, std::string& family) {
  reader.text(key, family);
  if (family.empty() || spec.families.contains(family)) return;
  std::vector<std::string> names;
  for (const auto& [name, entry] : spec.families)
    names.push_back(name);
  reader.fail(key, names.empty() ? "the table has no families"
                                 : fmt::format("'{}' is none of the families {}", family, fmt::join(names, ", ")));
}

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

TableLine read_line(TableReader& reader, const TableSpec& spec) {
  TableLine line;
  line.at = reader.place();
  reader.text("label", line.label);
  if (reader.has("show")) {
    line.kind = TableLine::Kind::show;
    reader.text("show", line.show, Need::required);
    if (line.label.empty()) line.label = line.show;
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
  reader.text("id", line.id);
  reader.text("json_quantity", line.json_quantity);
  check_quantity(reader, spec, line);
  if (line.is_ratio() && !line.decimals && !line.digits) line.decimals = 2;
  if (line.is_ratio() && line.interval) reader.fail("interval", "a ratio has no interval");
  reader.finish();
  return line;
}

/// The lines of a list, those of the sets that it names put in their places.
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
      const std::string near = nearest_name(name, names);
      row.fail("set", fmt::format("[row_sets] has no '{}'{}", name,
                                  near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
    }
    for (TableReader& inner : sets->tables(name, Need::required)) {
      if (inner.has("set")) inner.fail("set", "a set of rows names no other set");
      spec.lines.push_back(read_line(inner, spec));
    }
  }
}

void read_families(TableReader& reader, TableSpec& spec) {
  auto families = reader.table("families");
  if (families) {
    for (const std::string& name : families->keys()) {
      TableReader family = *families->table(name);
      std::vector<TableEntry> entries = read_combinations(family);
      if (entries.size() != 1)
        family.fail(family.place(), fmt::format("{}: a family has one value for each field", family.path()));
      // A family's field may take the value of the column's: hulls = "{hulls}".
      for (const auto& [field, values] : entries.front().where)
        entries.front().variables.erase(field);
      spec.families.emplace(name, std::move(entries.front()));
    }
  }
  read_family(reader, "family", spec, spec.family);
}

void read_records(TableReader& reader, TableSpec& spec) {
  for (const auto& [id, place] : reader.texts("records")) {
    if (spec.find_line(id) == nullptr)
      reader.fail(place, fmt::format("{}.records: no row has the id '{}'", reader.path(), id));
    spec.records.push_back(id);
  }
  if (spec.records.empty()) {
    for (const TableLine& line : spec.lines) {
      if (line.kind == TableLine::Kind::quantity && spec.records.empty()) spec.records.push_back(line.id);
    }
  }
  if (spec.records.empty()) reader.fail("rows", "no row shows a quantity");
}

/// All that differs between columns and groups, the result, and every line.
std::vector<RecordField> default_json(const TableSpec& spec) {
  std::vector<RecordField> fields;
  const auto add = [&](const std::string& name, const std::string& source) {
    const bool known = std::any_of(fields.begin(), fields.end(), [&](const RecordField& f) { return f.name == name; });
    if (!known) fields.push_back({name, source});
  };
  if (spec.grouped) add("group", "group");
  add("column", "name");
  for (const auto* entries : {&spec.groups, &spec.columns}) {
    for (const TableEntry& entry : *entries) {
      for (const auto& [name, value] : entry.variables)
        add(name, name);
    }
  }
  add("result", "result");
  for (const TableLine& line : spec.lines) {
    if (line.kind == TableLine::Kind::quantity) add(line.id, line.id);
  }
  return fields;
}

bool is_known(const TableSpec& spec, const std::string& source) {
  if (source == "name" || source == "group" || source == "result" || source == kNone) return true;
  if (spec.find_line(source) != nullptr || spec.entry.paper->find_quantity(source) != nullptr) return true;
  if (spec.all.variables.contains(source)) return true;
  for (const auto* entries : {&spec.groups, &spec.columns}) {
    for (const TableEntry& entry : *entries) {
      if (entry.variables.contains(source)) return true;
    }
  }
  return false;
}

void read_json(TableReader& reader, TableSpec& spec) {
  const toml::node* node = reader.node("json");
  if (node == nullptr) {
    spec.json = default_json(spec);
    return;
  }
  const toml::array* list = node->as_array();
  const auto fail = [&](const toml::node& at, std::string_view message) {
    reader.fail(place_of(at), fmt::format("{}.json: {}", reader.path(), message));
  };
  const auto add = [&](std::string name, std::string source, const toml::node& at) {
    if (!is_known(spec, source)) fail(at, fmt::format("'{}' is no variable, no row's id and no quantity", source));
    spec.json.push_back({std::move(name), std::move(source)});
  };
  if (list == nullptr) fail(*node, "a list of names, or of tables {name = \"source\"}");
  for (const toml::node& item : *list) {
    if (const auto name = item.value<std::string>()) {
      add(*name, *name, item);
      continue;
    }
    const toml::table* table = item.as_table();
    if (table == nullptr) fail(item, "an item is a name, or a table {name = \"source\"}");
    for (const auto& [name, source] : *table) {
      const auto text = source.value<std::string>();
      if (!text) fail(source, "a source is a name");
      add(std::string(name.str()), *text, source);
    }
  }
  const auto result = [](const RecordField& field) { return field.source == "result"; };
  if (std::none_of(spec.json.begin(), spec.json.end(), result))
    fail(*node, "\"result\" is missing: the place of `paper` and `ours`");
}

std::string read_sweep(TableReader& reader, const Paper& paper) {
  std::vector<std::string> names;
  for (const PaperSweep& sweep : paper.sweeps)
    names.push_back(sweep.name);
  if (!reader.has("sweep") && names.size() == 1) return names.front();
  std::string sweep;
  reader.text("sweep", sweep, Need::required);
  if (std::find(names.begin(), names.end(), sweep) == names.end()) {
    const std::string near = nearest_name(sweep, names);
    reader.fail("sweep", fmt::format("'{}' is none of the file's `sweeps`{}", sweep,
                                     near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
  }
  return sweep;
}

/// Tries every text that names variables, so that a mistake is found before there are rows.
void check_texts(const TableSpec& spec) {
  const TomlFile& file = spec.entry.paper->file;
  const auto at = [&](Place place, const auto& f) {
    try {
      f();
    } catch (const InputError& e) {
      throw file.error(place, e.what());
    }
  };
  for (const TableEntry& group : spec.groups) {
    const Variables of_group = merged(spec.all.variables, group.variables);
    at(group.at, [&] { expand(group.name, of_group); });
    for (const TableEntry& column : spec.columns) {
      const Variables all = merged(of_group, column.variables);
      at(column.at, [&] { expand(column.name, all); });
      for (const auto* entry : {&spec.all, &group, &column}) {
        for (const auto& [field, values] : entry->where) {
          for (const Value& value : values)
            at(entry->at, [&] { expand(to_text(value), all); });
        }
      }
      for (const auto& [name, family] : spec.families) {
        for (const auto& [field, values] : family.where) {
          for (const Value& value : values)
            at(family.at, [&] { expand(to_text(value), merged(all, family.variables)); });
        }
      }
    }
    for (const TableLine& line : spec.lines)
      at(line.at, [&] { expand(line.label + line.json_quantity, of_group); });
  }
}

}  // namespace

const TableLine* TableSpec::find_line(std::string_view id) const {
  for (const TableLine& line : lines) {
    if (line.kind == TableLine::Kind::quantity && line.id == id) return &line;
  }
  return nullptr;
}

TableSpec read_table_spec(const PaperEntry& entry) {
  const Paper& paper = *entry.paper;
  TableReader root = paper.read();
  TableReader reader = read_entry(entry, "tables");
  TableSpec spec;
  spec.entry = entry;
  spec.info.name = entry.full_name();
  spec.info.address = paper.address(entry.name);
  reader.text("title", spec.info.title, Need::required);
  reader.text("source", spec.info.source);
  if (spec.info.source.empty()) spec.info.source = paper.source;
  spec.info.spec = read_sweep(reader, paper);
  for (const PaperSweep& sweep : paper.sweeps) {
    if (sweep.name == spec.info.spec) spec.info.spec_path = sweep.spec;
  }
  for (auto& [note, place] : reader.texts("notes"))
    spec.notes.push_back(note);
  read_where(reader, spec.all);

  std::string column_name;
  reader.text("name", column_name);
  spec.columns = read_entries(reader, "columns", column_name);
  spec.grouped = reader.has("groups");
  if (spec.grouped) spec.groups = read_entries(reader, "groups", "");
  if (!spec.grouped) spec.groups.emplace_back();
  reader.boolean("skip_empty_groups", spec.skip_empty_groups);
  read_families(reader, spec);
  reader.boolean("transposed", spec.transposed);
  spec.label = spec.transposed ? "{group}: {row}" : "{row}, {group}";
  reader.text("label", spec.label);
  reader.text("corner", spec.corner);
  if (!spec.transposed && reader.has("corner")) reader.fail("corner", "only a transposed table has one");

  read_lines(reader, root, spec);
  const auto shown = std::find_if(spec.lines.begin(), spec.lines.end(),
                                  [](const TableLine& line) { return line.kind != TableLine::Kind::show; });
  double heading_rows = spec.transposed ? 1 : static_cast<double>(shown - spec.lines.begin());
  if (heading_rows == 0) reader.fail("rows", "the first row names the columns: {show = \"…\"}");
  reader.integer("heading_rows", heading_rows, {1, static_cast<double>(spec.lines.size())});
  spec.heading_rows = static_cast<std::size_t>(heading_rows);
  read_records(reader, spec);
  read_json(reader, spec);

  const bool published =
      std::any_of(spec.lines.begin(), spec.lines.end(), [](const TableLine& line) { return !line.published.empty(); });
  if (published) spec.paper_note = paper.machine;
  reader.text("paper_note", spec.paper_note);
  reader.finish();
  check_texts(spec);
  return spec;
}

}  // namespace pellucid::sweeps
