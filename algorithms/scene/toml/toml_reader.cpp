#include "algorithms/scene/toml/toml_reader.hpp"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "algorithms/parameters.hpp"

namespace pellucid {

namespace {

FilePosition begin_of(const toml::source_region& region) {
  return {static_cast<int>(region.begin.line), static_cast<int>(region.begin.column)};
}

}  // namespace

FilePosition place_of(const toml::node& node) {
  return begin_of(node.source());
}

InputError TomlFile::error(FilePosition place, std::string_view message) const {
  return InputError(fmt::format("{}:{}:{}: {}", shown, place.line, place.column, message));
}

std::string read_toml_text(const std::string& path, std::string_view what, std::uintmax_t most_bytes) {
  std::error_code error;
  const auto refuse = [&](std::string_view reason) {
    return InputError(fmt::format("cannot read {} '{}': {}", what, path, reason));
  };
  if (!std::filesystem::is_regular_file(path, error))
    throw refuse(std::filesystem::exists(path, error) ? "not a regular file" : "No such file or directory");
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (!error && bytes > most_bytes)
    throw refuse(fmt::format("{} bytes; a {} file has at most {}", bytes, what, most_bytes));
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file.is_open() || file.bad()) throw refuse(std::strerror(errno));
  return text;
}

std::shared_ptr<toml::table> parse_toml(std::string_view text, const TomlFile& file) {
  try {
    return std::make_shared<toml::table>(toml::parse(text, file.shown));
  } catch (const toml::parse_error& error) {
    throw file.error(begin_of(error.source()), error.description());
  }
}

std::string NumberRange::text() const {
  return fmt::format("{}{}, {}]", above_min ? '(' : '[', min, max);
}

bool is_name(std::string_view name) {
  const auto letter = [](char c) { return c >= 'a' && c <= 'z'; };
  return !name.empty() && letter(name.front()) &&
         std::all_of(name.begin(), name.end(), [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_'; });
}

std::string_view type_name(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "a list";
    case toml::node_type::string:
      return "a string";
    case toml::node_type::integer:
      return "an integer";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "a boolean";
    default:
      return "a date or time";
  }
}

namespace {

std::string wrong_type(std::string_view shown, std::string_view wanted, const toml::node& found) {
  return fmt::format("{} must be {}, not {}", shown, wanted, type_name(found));
}

}  // namespace

void TableReader::fail(FilePosition at, std::string_view message) const {
  throw file_->error(at, message);
}

void TableReader::fail(std::string_view key, std::string_view message) const {
  fail(place(key), fmt::format("{}: {}", dotted(key), message));
}

FilePosition TableReader::place_of_table() const {
  return place_of(*table_);
}

FilePosition TableReader::place(std::string_view key) const {
  const toml::node* node = table_->get(key);
  return node != nullptr ? place_of(*node) : place_of_table();
}

FilePosition TableReader::place_of_key(std::string_view key) const {
  for (auto&& [own, node] : *table_) {
    if (own.str() == key) return begin_of(own.source());
  }
  assert(false);
  return place_of_table();
}

std::string TableReader::dotted(std::string_view key) const {
  return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

bool TableReader::has(std::string_view key) const {
  return table_->contains(key);
}

const toml::node* TableReader::find(std::string_view key, Need need) {
  // Errors list each key once, though a reader may look at it twice.
  if (std::find(asked_.begin(), asked_.end(), key) == asked_.end()) asked_.emplace_back(key);
  if (need == Need::required) require(key);
  return table_->get(key);
}

void TableReader::require(std::string_view key) {
  if (table_->contains(key)) return;
  const std::string missing =
      path_.empty() ? fmt::format("'{}' is missing", key) : fmt::format("'{}' is missing in {}", key, path_);
  // Most likely it is there with a typing error. Short names all look alike.
  std::vector<std::string> others;
  for (auto&& [other, node] : *table_) {
    if (other.str().size() >= 4) others.emplace_back(other.str());
  }
  const std::string near = nearest_name(key, others);
  if (near.empty()) fail(place_of_table(), missing);
  for (auto&& [other, node] : *table_) {
    if (other.str() == near) fail(begin_of(other.source()), fmt::format("{}; is it '{}'?", missing, near));
  }
}

void TableReader::one_of(FilePosition place, std::string_view what, std::string_view value,
                         std::span<const std::string> names) const {
  if (std::find(names.begin(), names.end(), value) != names.end()) return;
  const std::string near = nearest_name(value, names);
  fail(place, fmt::format("unknown {} '{}'; {}", what, value,
                          near.empty() ? fmt::format("there are {}", fmt::join(names, ", "))
                                       : fmt::format("did you mean '{}'?", near)));
}

void TableReader::exclude(std::string_view key, std::string_view other) {
  if (has(key) && has(other)) fail(place(key), fmt::format("{} and {} exclude each other", dotted(key), dotted(other)));
}

double TableReader::scalar(const toml::node& node, const std::string& shown, NumberRange range, bool integer) const {
  double value = 0;
  if (const auto* whole = node.as_integer()) {
    value = static_cast<double>(whole->get());
  } else if (const auto* real = node.as_floating_point(); real != nullptr && !integer) {
    value = real->get();
  } else {
    fail(place_of(node), wrong_type(shown, integer ? "an integer" : "a number", node));
  }
  if (!range.contains(value)) {  // NaN too
    fail(place_of(node), fmt::format("{} = {} is out of range {}", shown, value, range.text()));
  }
  return value;
}

void TableReader::add_target(std::string path, std::vector<double*> numbers, NumberRange range, bool integer,
                             const toml::node* node) {
  if (!affected_) return;
  targets_->push_back({std::move(path),
                       std::move(numbers),
                       range,
                       integer,
                       node != nullptr,
                       node != nullptr ? place_of(*node) : place_of_table(),
                       *affected_,
                       {}});
}

void TableReader::number(std::string_view key, double& value, NumberRange range, Need need) {
  const toml::node* node = find(key, need);
  if (node != nullptr) value = scalar(*node, dotted(key), range, false);
  add_target(dotted(key), {&value}, range, false, node);
}

void TableReader::integer(std::string_view key, double& value, NumberRange range, Need need) {
  const toml::node* node = find(key, need);
  if (node != nullptr) value = scalar(*node, dotted(key), range, true);
  add_target(dotted(key), {&value}, range, true, node);
}

void TableReader::integer(std::string_view key, int& value, int min, int max, Need need) {
  const toml::node* node = find(key, need);
  if (node == nullptr) return;
  const NumberRange range{static_cast<double>(min), static_cast<double>(max)};
  value = static_cast<int>(scalar(*node, dotted(key), range, true));
}

void TableReader::components(std::string_view key, double* values, std::size_t count, NumberRange range, bool integer,
                             bool one_for_all, std::string_view names, Need need) {
  const toml::node* node = find(key, need);
  components(dotted(key), node, values, count, range, integer, one_for_all, names);
}

void TableReader::components(const std::string& shown, const toml::node* node, double* values, std::size_t count,
                             NumberRange range, bool integer, bool one_for_all, std::string_view names) {
  const std::string letters = fmt::format("{}", fmt::join(names.begin(), names.end(), ", "));
  std::vector<double*> all;
  std::vector<const toml::node*> nodes(count, node);
  if (node != nullptr && one_for_all && node->is_number()) {
    const double value = scalar(*node, shown, range, integer);
    std::fill_n(values, count, value);
  } else if (node != nullptr) {
    const toml::array* array = node->as_array();
    if (array == nullptr) {
      fail(place_of(*node),
           wrong_type(shown, fmt::format("[{}]{}", letters, one_for_all ? " or a number" : ""), *node));
    }
    if (array->size() != count) {
      fail(place_of(*node), fmt::format("{} must have {} numbers [{}], not {}", shown, count, letters, array->size()));
    }
    for (std::size_t i = 0; i < count; ++i) {
      nodes[i] = array->get(i);
      values[i] = scalar(*nodes[i], fmt::format("{}.{}", shown, names[i]), range, integer);
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    add_target(fmt::format("{}.{}", shown, names[i]), {values + i}, range, integer, nodes[i]);
    all.push_back(values + i);
  }
  if (one_for_all) add_target(shown, all, range, integer, node);
}

void TableReader::vector(std::string_view key, glm::dvec2& value, NumberRange range, Need need) {
  components(key, &value.x, 2, range, false, false, "xz", need);
}

void TableReader::vector(std::string_view key, glm::dvec3& value, NumberRange range, Need need) {
  components(key, &value.x, 3, range, false, false, "xyz", need);
}

void TableReader::color(std::string_view key, glm::dvec3& value, NumberRange range, Need need) {
  components(key, &value.x, 3, range, false, true, "rgb", need);
}

void TableReader::extent(std::string_view key, glm::dvec3& value, NumberRange range, bool integers, Need need) {
  components(key, &value.x, 3, range, integers, true, "xyz", need);
}

void TableReader::pair(std::string_view key, glm::dvec2& value, NumberRange range, bool integers, Need need) {
  double values[2] = {value.x, value.y};
  const toml::node* node = find(key, need);
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  if (array == nullptr || array->size() != 2) {
    fail(place_of(*node), fmt::format("{} must be two numbers [min, max]", dotted(key)));
  }
  for (std::size_t i = 0; i < 2; ++i)
    values[i] = scalar(*array->get(i), dotted(key), range, integers);
  value = {values[0], values[1]};
}

void TableReader::points(std::string_view key, std::vector<glm::dvec3>& values, NumberRange range, std::size_t most) {
  const toml::node* node = find(key, Need::optional);
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  if (array == nullptr) fail(place_of(*node), wrong_type(dotted(key), "a list of points [[x, y, z], …]", *node));
  if (array->empty() || array->size() > most)
    fail(place_of(*node), fmt::format("{} must have 1 to {} points, not {}", dotted(key), most, array->size()));
  values.resize(array->size());
  for (std::size_t i = 0; i < values.size(); ++i)
    components(fmt::format("{}[{}]", dotted(key), i), array->get(i), &values[i].x, 3, range, false, false, "xyz");
}

void TableReader::boolean(std::string_view key, bool& value) {
  const toml::node* node = find(key, Need::optional);
  if (node == nullptr) return;
  if (!node->is_boolean()) fail(place_of(*node), wrong_type(dotted(key), "true or false", *node));
  value = node->as_boolean()->get();
}

void TableReader::text(std::string_view key, std::string& value, Need need) {
  const toml::node* node = find(key, need);
  if (node == nullptr) return;
  if (!node->is_string()) fail(place_of(*node), wrong_type(dotted(key), "a string", *node));
  value = node->as_string()->get();
  if (value.empty() && need == Need::required) fail(place_of(*node), fmt::format("{} is empty", dotted(key)));
}

std::size_t TableReader::choice(std::string_view key, std::initializer_list<std::string_view> choices,
                                std::size_t otherwise) {
  std::string value;
  text(key, value);
  if (!has(key)) return otherwise;
  const auto* it = std::find(choices.begin(), choices.end(), value);
  if (it == choices.end()) {
    const std::vector<std::string> names(choices.begin(), choices.end());
    const std::string near = nearest_name(value, names);
    fail(place(key), fmt::format("{} = '{}' is not one of {}{}", dotted(key), value, fmt::join(names, ", "),
                                 near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
  }
  return static_cast<std::size_t>(it - choices.begin());
}

std::vector<std::pair<std::string, FilePosition>> TableReader::texts(std::string_view key, Need need) {
  std::vector<std::pair<std::string, FilePosition>> result;
  const toml::node* node = find(key, need);
  if (node == nullptr) return result;
  const toml::array* array = node->as_array();
  if (array == nullptr) fail(place_of(*node), wrong_type(dotted(key), "a list of strings", *node));
  for (const toml::node& element : *array) {
    if (!element.is_string()) fail(place_of(element), wrong_type(dotted(key), "a list of strings", element));
    result.emplace_back(element.as_string()->get(), place_of(element));
  }
  return result;
}

std::optional<TableReader> TableReader::table(std::string_view key) {
  const toml::node* node = find(key, Need::optional);
  if (node == nullptr) return std::nullopt;
  const toml::table* table = node->as_table();
  if (table == nullptr) fail(place_of(*node), wrong_type(dotted(key), "a table", *node));
  TableReader reader = inner(*table, dotted(key));
  reader.set_affected(affected_);
  return reader;
}

TableReader TableReader::inner(const toml::table& table, std::string path) const {
  TableReader reader(*file_, table, std::move(path));
  reader.targets_ = targets_;
  return reader;
}

std::vector<std::string> TableReader::keys() const {
  std::vector<std::pair<FilePosition, std::string>> found;
  for (auto&& [key, node] : *table_)
    found.emplace_back(begin_of(key.source()), key.str());
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return std::pair(a.first.line, a.first.column) < std::pair(b.first.line, b.first.column);
  });
  std::vector<std::string> keys;
  for (auto& [place, key] : found)
    keys.push_back(std::move(key));
  return keys;
}

std::vector<std::pair<std::string, TableReader>> TableReader::named_tables(std::string_view key) {
  std::vector<std::pair<std::string, TableReader>> result;
  const std::optional<TableReader> outer = table(key);
  if (!outer) return result;
  for (auto&& [name, node] : *outer->table_) {
    if (!is_name(name.str())) {
      fail(begin_of(name.source()),
           fmt::format("'{}' is not a name: use lower-case letters, digits and underscores, a letter first",
                       name.str()));
    }
    const toml::table* inner = node.as_table();
    if (inner == nullptr) fail(place_of(node), wrong_type(outer->dotted(name.str()), "a table", node));
    result.emplace_back(name.str(), this->inner(*inner, outer->dotted(name.str())));
  }
  // toml++ sorts by name; the order of the file tells which view is the first.
  std::stable_sort(result.begin(), result.end(), [](const auto& a, const auto& b) {
    const FilePosition pa = a.second.place();
    const FilePosition pb = b.second.place();
    return std::pair(pa.line, pa.column) < std::pair(pb.line, pb.column);
  });
  return result;
}

std::vector<TableReader> TableReader::tables(std::string_view key, Need need) {
  std::vector<TableReader> result;
  const toml::node* node = find(key, need);
  if (node == nullptr) return result;
  const toml::array* array = node->as_array();
  if (array == nullptr) fail(place_of(*node), wrong_type(dotted(key), "a list of tables", *node));
  for (const toml::node& element : *array) {
    const toml::table* inner = element.as_table();
    if (inner == nullptr) fail(place_of(element), wrong_type(dotted(key), "a list of tables", element));
    result.push_back(this->inner(*inner, fmt::format("{}[{}]", dotted(key), result.size())));
  }
  return result;
}

void TableReader::finish() {
  for (auto&& [key, node] : *table_) {
    if (std::find(asked_.begin(), asked_.end(), key.str()) != asked_.end()) continue;
    const std::string near = nearest_name(key.str(), asked_);
    fail(begin_of(key.source()), fmt::format("unknown key '{}'{}; {}", key.str(), path_.empty() ? "" : " in " + path_,
                                             near.empty() ? fmt::format("known are {}", fmt::join(asked_, ", "))
                                                          : fmt::format("did you mean '{}'?", near)));
  }
}

}  // namespace pellucid
