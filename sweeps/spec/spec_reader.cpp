#include "sweeps/spec/spec_reader.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "algorithms/render_session.hpp"
#include "algorithms/scene/images/image.hpp"
#include "algorithms/scene/toml/toml_reader.hpp"
#include "gl/error.hpp"

namespace pellucid::sweeps {
namespace {

Position to_position(const toml::source_region& region) {
  return {region.begin.line, region.begin.column};
}

/// Keys in the order of the file; toml++ sorts them by name.
std::vector<std::pair<const toml::key*, const toml::node*>> in_file_order(const toml::table& table) {
  std::vector<std::pair<const toml::key*, const toml::node*>> keys;
  for (const auto& [key, node] : table)
    keys.emplace_back(&key, &node);
  std::sort(keys.begin(), keys.end(), [](const auto& a, const auto& b) {
    const Position pa = to_position(a.first->source());
    const Position pb = to_position(b.first->source());
    return pa.line != pb.line ? pa.line < pb.line : pa.column < pb.column;
  });
  return keys;
}

}  // namespace

void SpecReader::fail(Position at, std::string_view message) const {
  throw InputError(fmt::format("{}:{}:{}: {}", source_, at.line, at.column, message));
}

Position SpecReader::position(const toml::node& node) const {
  return to_position(node.source());
}

void SpecReader::at(const toml::node& node, const std::function<void()>& f) const {
  try {
    f();
  } catch (const InputError& e) {
    fail(node, e.what());
  }
}

void SpecReader::allow(const toml::table& table, std::initializer_list<std::string_view> keys,
                       std::string_view where) const {
  for (const auto& [key, node] : in_file_order(table)) {
    if (std::find(keys.begin(), keys.end(), key->str()) != keys.end()) continue;
    const std::vector<std::string> names(keys.begin(), keys.end());
    const std::string near = nearest_name(key->str(), names);
    fail(to_position(key->source()), fmt::format("unknown key '{}' in {}; {}", key->str(), where,
                                                 near.empty() ? fmt::format("it has {}", fmt::join(names, ", "))
                                                              : fmt::format("did you mean '{}'?", near)));
  }
}

void SpecReader::one_of(const toml::node& node, const std::string& value, std::span<const std::string> allowed,
                        std::string_view what) const {
  if (std::find(allowed.begin(), allowed.end(), value) != allowed.end()) return;
  const std::string near = nearest_name(value, allowed);
  fail(node, fmt::format("unknown {} '{}'; {}", what, value,
                         near.empty() ? fmt::format("there are {}", fmt::join(allowed, ", "))
                                      : fmt::format("did you mean '{}'?", near)));
}

bool SpecReader::text(const toml::table& table, std::string_view key, std::string& out) const {
  const toml::node* node = table.get(key);
  if (node == nullptr) return false;
  if (!node->is_string()) fail(*node, fmt::format("{} is a string, not {}", key, type_name(*node)));
  out = node->as_string()->get();
  return true;
}

bool SpecReader::boolean(const toml::table& table, std::string_view key, bool& out) const {
  const toml::node* node = table.get(key);
  if (node == nullptr) return false;
  if (!node->is_boolean()) fail(*node, fmt::format("{} is true or false, not {}", key, type_name(*node)));
  out = node->as_boolean()->get();
  return true;
}

bool SpecReader::integer(const toml::table& table, std::string_view key, int min, int max, int& out) const {
  const toml::node* node = table.get(key);
  if (node == nullptr) return false;
  if (!node->is_integer()) fail(*node, fmt::format("{} is an integer, not {}", key, type_name(*node)));
  const std::int64_t value = node->as_integer()->get();
  if (value < min || value > max) fail(*node, fmt::format("{} = {} is out of range [{}, {}]", key, value, min, max));
  out = static_cast<int>(value);
  return true;
}

bool SpecReader::real(const toml::table& table, std::string_view key, double min, double max, double& out) const {
  const toml::node* node = table.get(key);
  if (node == nullptr) return false;
  const double value = number(*node, key);
  if (!(value >= min && value <= max))
    fail(*node, fmt::format("{} = {} is out of range [{}, {}]", key, value, min, max));
  out = value;
  return true;
}

double SpecReader::number(const toml::node& node, std::string_view name) const {
  if (node.is_integer()) return static_cast<double>(node.as_integer()->get());
  if (node.is_floating_point()) return node.as_floating_point()->get();
  fail(node, fmt::format("{} is a number, not {}", name, type_name(node)));
}

const toml::table* SpecReader::table(const toml::table& parent, std::string_view key) const {
  const toml::node* node = parent.get(key);
  if (node == nullptr) return nullptr;
  if (!node->is_table()) fail(*node, fmt::format("{} is a table, not {}", key, type_name(*node)));
  return node->as_table();
}

std::string SpecReader::identifier(const toml::table& table, std::string_view key, Position at) const {
  std::string name;
  if (!text(table, key, name)) fail(at, fmt::format("{} is missing", key));
  const auto good = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  if (name.empty() || name.size() > 100 || !std::all_of(name.begin(), name.end(), good)) {
    fail(*table.get(key), fmt::format("{} = '{}' is not a name of a-z, 0-9 and _", key, name));
  }
  return name;
}

std::vector<SpecReader::Text> SpecReader::texts(const toml::table& table, std::string_view key,
                                                bool may_be_empty) const {
  const toml::node* node = table.get(key);
  return node == nullptr ? std::vector<Text>{} : texts(*node, key, may_be_empty);
}

std::vector<SpecReader::Text> SpecReader::texts(const toml::node& node, std::string_view key, bool may_be_empty) const {
  const toml::array* list = node.as_array();
  if (list == nullptr) fail(node, fmt::format("{} is a list of strings, not {}", key, type_name(node)));
  if (list->empty() && !may_be_empty) fail(node, fmt::format("{} is empty", key));
  std::vector<Text> result;
  for (const toml::node& item : *list) {
    if (!item.is_string()) fail(item, fmt::format("{} is a list of strings, not of {}", key, type_name(item)));
    std::string value = item.as_string()->get();
    if (std::any_of(result.begin(), result.end(), [&](const Text& t) { return t.value == value; })) {
      fail(item, fmt::format("{} lists '{}' twice", key, value));
    }
    result.push_back({std::move(value), &item});
  }
  return result;
}

std::vector<SpecReader::Text> SpecReader::required_texts(const toml::table& table, std::string_view key,
                                                         Position at) const {
  if (!table.contains(key)) fail(at, fmt::format("{} is missing", key));
  return texts(table, key, false);
}

std::vector<SpecReader::Entry> SpecReader::entries(const toml::table& table) const {
  std::vector<Entry> result;
  const auto add = [&](std::string name, const toml::key& key, const toml::node& node) {
    const Position at = to_position(key.source());
    if (std::any_of(result.begin(), result.end(), [&](const Entry& e) { return e.name == name; })) {
      fail(at, fmt::format("{} is given twice", name));
    }
    result.push_back({std::move(name), at, &node});
  };
  for (const auto& [key, node] : in_file_order(table)) {
    const auto groups = common_settings();
    const bool known = key->str() == "scene" || std::any_of(groups.begin(), groups.end(), [&](const CommonSettings& g) {
                         return g.prefix == key->str();
                       });
    const bool group = known && node->is_table();
    if (!group) {
      add(std::string(key->str()), *key, *node);
      continue;
    }
    for (const auto& [inner_key, inner] : in_file_order(*node->as_table())) {
      add(fmt::format("{}.{}", key->str(), inner_key->str()), *inner_key, *inner);
    }
  }
  return result;
}

Value SpecReader::value(const toml::node& node, std::string_view name) const {
  if (node.is_boolean()) return node.as_boolean()->get();
  if (node.is_integer()) return node.as_integer()->get();
  if (node.is_floating_point()) return node.as_floating_point()->get();
  if (node.is_string()) return node.as_string()->get();
  fail(node, fmt::format("{} is a boolean, a number or a string, not {}", name, type_name(node)));
}

AxisRange SpecReader::range(const toml::table& table, std::string_view name) const {
  allow(table, {"from", "to", "steps", "log2"}, fmt::format("the range of {}", name));
  AxisRange range;
  for (const char* key : {"from", "to"}) {
    if (!table.contains(key)) fail(table, fmt::format("the range of {} lacks `{}`", name, key));
  }
  range.from = number(*table.get("from"), "from");
  range.to = number(*table.get("to"), "to");
  if (const toml::node* steps = table.get("steps")) {
    if (!steps->is_integer()) fail(*steps, fmt::format("steps is an integer, not {}", type_name(*steps)));
    range.steps = steps->as_integer()->get();
  }
  boolean(table, "log2", range.log2);
  return range;
}

Size SpecReader::size(const Text& text) const {
  const char* end = text.value.data() + text.value.size();
  int width = 0;
  int height = 0;
  const auto [x, first] = std::from_chars(text.value.data(), end, width);
  if (first != std::errc{} || x == end || *x != 'x')
    fail(*text.node, fmt::format("size '{}' is not WIDTHxHEIGHT", text.value));
  const auto [rest, second] = std::from_chars(x + 1, end, height);
  if (second != std::errc{} || rest != end) fail(*text.node, fmt::format("size '{}' is not WIDTHxHEIGHT", text.value));
  at(*text.node, [&] { check_image_size(width, height, "size " + text.value); });
  return {width, height};
}

std::string SpecReader::resolve_scene(const std::string& scene) const {
  const std::filesystem::path path(scene);
  if (!scene.ends_with(".toml") || path.is_absolute()) return scene;
  return (std::filesystem::path(source_).parent_path() / path).lexically_normal().string();
}

}  // namespace pellucid::sweeps
