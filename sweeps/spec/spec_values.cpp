#include "sweeps/spec/spec_values.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <limits>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "algorithms/render_session.hpp"
#include "algorithms/scene/images/frame_size.hpp"
#include "algorithms/scene/images/image.hpp"
#include "gl/error.hpp"

namespace pellucid::sweeps {
namespace {

bool is_group_of_settings(std::string_view name) {
  const auto groups = common_settings();
  return name == "scene" ||
         std::any_of(groups.begin(), groups.end(), [&](const CommonSettings& group) { return group.prefix == name; });
}

void add_values(TableReader& reader, const std::string& prefix, std::vector<NamedValue>& values) {
  for (const std::string& key : reader.keys()) {
    const toml::node* node = reader.node(key);
    std::optional<TableReader> table = node->is_table() ? reader.table(key) : std::nullopt;
    if (prefix.empty() && table && is_group_of_settings(key)) {
      add_values(*table, key + ".", values);
      continue;
    }
    const FilePosition at = reader.place_of_key(key);
    std::string name = prefix + key;
    if (std::any_of(values.begin(), values.end(), [&](const NamedValue& other) { return other.name == name; }))
      reader.fail(at, fmt::format("{} is given twice", name));
    values.push_back({std::move(name), at, node, std::move(table)});
  }
}

}  // namespace

std::vector<PlacedText> distinct_texts(TableReader& reader, std::string_view key, Need need, bool may_be_empty) {
  std::vector<PlacedText> result;
  for (auto& [text, at] : reader.texts(key, need)) {
    const auto same = [&text = text](const PlacedText& other) { return other.text == text; };
    if (std::any_of(result.begin(), result.end(), same)) reader.fail(at, fmt::format("{} lists '{}' twice", key, text));
    result.push_back({std::move(text), at});
  }
  if (result.empty() && reader.has(key) && !may_be_empty)
    reader.fail(reader.place(key), fmt::format("{} is empty", key));
  return result;
}

std::string identifier(TableReader& reader, std::string_view key) {
  std::string name;
  reader.text(key, name, Need::required);
  const auto good = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  if (name.size() > 100 || !std::all_of(name.begin(), name.end(), good))
    reader.fail(reader.place(key), fmt::format("{} = '{}' is not a name of a-z, 0-9 and _", key, name));
  return name;
}

std::vector<NamedValue> named_values(TableReader& reader) {
  std::vector<NamedValue> values;
  add_values(reader, "", values);
  return values;
}

Value value_of(const TableReader& reader, const toml::node& node, std::string_view name) {
  if (node.is_boolean()) return node.as_boolean()->get();
  if (node.is_integer()) return node.as_integer()->get();
  if (node.is_floating_point()) return node.as_floating_point()->get();
  if (node.is_string()) return node.as_string()->get();
  reader.fail(place_of(node), fmt::format("{} is a boolean, a number or a string, not {}", name, type_name(node)));
}

AxisRange read_range(TableReader& reader) {
  // Ends that no parameter could take are refused with the parameter's own range; NaN is refused there as well.
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  AxisRange range;
  reader.number("from", range.from, {-kInfinity, kInfinity}, Need::required);
  reader.number("to", range.to, {-kInfinity, kInfinity}, Need::required);
  if (const toml::node* steps = reader.node("steps")) {
    if (!steps->is_integer())
      reader.fail(place_of(*steps), fmt::format("steps is an integer, not {}", type_name(*steps)));
    range.steps = steps->as_integer()->get();
  }
  reader.boolean("log2", range.log2);
  reader.finish();
  return range;
}

FrameSize read_size(const TableReader& reader, const PlacedText& size) {
  try {
    return parse_frame_size(size.text, "size");
  } catch (const InputError& e) {
    reader.fail(size.at, e.what());
  }
}

}  // namespace pellucid::sweeps
