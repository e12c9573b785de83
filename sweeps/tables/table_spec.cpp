#include "sweeps/tables/table_spec.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "gl/error.hpp"
#include "sweeps/tables/table_entries.hpp"

namespace pellucid::sweeps {
namespace {

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
    reader.fail("sweep", fmt::format("'{}' is none of the file's `sweeps`{}", sweep, name_hint(sweep, names)));
  }
  return sweep;
}

/// Tries every text that names variables, so that a mistake is found before there are rows.
void check_texts(const TableSpec& spec) {
  const TomlFile& file = spec.entry.paper->file;
  const auto at = [&](FilePosition place, const auto& f) {
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
      Variables named = all;
      at(column.at, [&] { named["name"] = expand(column.name, all); });
      for (const TableLine& line : spec.lines) {
        if (line.show.find('{') != std::string::npos) at(line.at, [&] { expand(line.show, named); });
      }
      for (const auto* entry : {&spec.all, &group, &column}) {
        for (const auto& [field, values] : entry->where) {
          for (const Value& value : values)
            at(entry->at, [&] { expand(to_text(value), all); });
        }
      }
      for (const auto& [name, family] : spec.families) {
        for (const auto& [field, values] : family.where) {
          for (const Value& value : values)
            at(family.at, [&, &family = family] { expand(to_text(value), merged(all, family.variables)); });
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
  if (spec.info.source.empty()) spec.info.source = paper.source.empty() ? "ours" : paper.source;
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
