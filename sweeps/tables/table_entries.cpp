#include "sweeps/tables/table_entries.hpp"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <toml++/toml.h>

namespace pellucid::sweeps {
namespace {

constexpr std::size_t kMost = 1000;  // columns of a table that anybody reads

/// A field or a variable, and what it may be.
struct Choice {
  std::string name;
  bool field = false;          ///< of the rows, else a variable
  std::vector<Value> product;  ///< one entry for each
  std::vector<Value> any;      ///< or: a row may have any of these
};

Value value_of_node(const TableReader& reader, const toml::node& node, std::string_view name) {
  if (const auto* flag = node.as_boolean()) return flag->get();
  if (const auto* whole = node.as_integer()) return whole->get();
  if (const auto* real = node.as_floating_point()) return real->get();
  if (const auto* text = node.as_string()) return text->get();
  reader.fail(place_of(node),
              fmt::format("{}.{} is a boolean, a number or a string, not {}", reader.path(), name, type_name(node)));
}

std::vector<Value> values_of_list(const TableReader& reader, const toml::node& node, std::string_view name) {
  std::vector<Value> values;
  const toml::array* list = node.as_array();
  if (list == nullptr || list->empty())
    reader.fail(place_of(node), fmt::format("{}.{} must be a list of at least one value", reader.path(), name));
  for (const toml::node& item : *list)
    values.push_back(value_of_node(reader, item, name));
  return values;
}

/// `scene.time_s = 5` is a table in a table.
void add_choices(TableReader& reader, const std::string& key, const std::string& prefix, bool field,
                 std::vector<Choice>& choices) {
  const toml::node& node = *reader.node(key);
  const std::string name = prefix + key;
  if (!node.is_table()) {
    Choice choice{name, field, {}, {}};
    choice.product =
        node.is_array() ? values_of_list(reader, node, key) : std::vector{value_of_node(reader, node, key)};
    choices.push_back(std::move(choice));
    return;
  }
  TableReader inner = *reader.table(key);
  const std::vector<std::string> keys = inner.keys();
  if (field && keys.size() == 1 && keys.front() == "any") {
    choices.push_back({name, field, {}, values_of_list(inner, *inner.node("any"), "any")});
    return;
  }
  for (const std::string& part : keys)
    add_choices(inner, part, name + ".", field, choices);
}

void add_with(TableReader& reader, std::vector<Choice>& choices) {
  if (auto with = reader.table("with")) {
    for (const std::string& key : with->keys())
      add_choices(*with, key, "", false, choices);
  }
}

void put(const Choice& choice, const Value& value, TableEntry& entry) {
  if (choice.field) entry.where.emplace_back(choice.name, std::vector{value});
  entry.variables[choice.name] = value;
}

std::vector<TableEntry> combine(const TableReader& reader, const TableEntry& common,
                                const std::vector<Choice>& choices) {
  std::vector<TableEntry> entries{common};
  for (const Choice& choice : choices) {
    if (choice.product.empty()) {
      for (TableEntry& entry : entries)
        entry.where.emplace_back(choice.name, choice.any);
      continue;
    }
    std::vector<TableEntry> next;
    for (const TableEntry& entry : entries) {
      for (const Value& value : choice.product)
        put(choice, value, next.emplace_back(entry));
    }
    entries = std::move(next);
    if (entries.size() > kMost)
      reader.fail(reader.place(), fmt::format("{} has more than {} combinations", reader.path(), kMost));
  }
  return entries;
}

}  // namespace

std::vector<TableEntry> read_combinations(TableReader& reader) {
  TableEntry common;
  common.at = reader.place();
  reader.text("name", common.name);
  std::vector<Choice> choices;
  for (const std::string& key : reader.keys()) {
    if (key == "with") {
      add_with(reader, choices);
    } else if (key != "name") {
      add_choices(reader, key, "", true, choices);
    }
  }
  return combine(reader, common, choices);
}

std::vector<TableEntry> read_entries(TableReader& reader, const std::string& key, const std::string& default_name) {
  std::vector<TableEntry> entries;
  const auto add = [&](TableReader& table) {
    for (TableEntry& entry : read_combinations(table)) {
      if (entry.name.empty()) entry.name = default_name;
      if (entry.name.empty()) {
        for (const auto& [name, value] : entry.variables)
          entry.name += fmt::format("{}{}", entry.name.empty() ? "" : ", ", to_text(value));
      }
      entries.push_back(std::move(entry));
    }
  };
  const toml::node* node = reader.node(key, Need::required);
  if (node->is_table()) {
    TableReader product = *reader.table(key);
    add(product);
  } else {
    for (TableReader& table : reader.tables(key, Need::required))
      add(table);
  }
  if (entries.empty()) reader.fail(key, "it is empty");
  return entries;
}

void read_where(TableReader& reader, TableEntry& entry) {
  std::vector<Choice> choices;
  if (auto where = reader.table("where")) {
    for (const std::string& key : where->keys())
      add_choices(*where, key, "", true, choices);
  }
  add_with(reader, choices);
  entry.at = reader.place();
  std::vector<TableEntry> one = combine(reader, entry, choices);
  if (one.size() != 1)
    reader.fail("where", "one value for each field, or {any = […]}; lists belong into columns and groups");
  entry = std::move(one.front());
}

}  // namespace pellucid::sweeps
