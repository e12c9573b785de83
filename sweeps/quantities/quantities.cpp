#include "sweeps/quantities/quantities.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <toml++/toml.h>

#include "gl/resources/resources.hpp"
#include "sweeps/spec/constraint.hpp"
#include "sweeps/store/rows.hpp"

namespace pellucid::sweeps {
namespace {

constexpr std::string_view kOwnFile = "sweeps/quantities/quantities.toml";

/// A declaration that stands for several fields: "mean error of the exit point" and its kin.
struct Variant {
  const char* suffix;
  const char* before;  ///< of label and heading
  const char* after;
  const char* doc;  ///< behind the declaration's
};
constexpr std::array<Variant, 4> kStatistics{{{"_mean", "mean ", "", ": the mean"},
                                              {"_median", "median ", "", ": the median"},
                                              {"_q95", "95 % quantile of the ", "", ": what 95 % stay below"},
                                              {"_max", "largest ", "", ": the largest"}}};
constexpr std::array<Variant, 3> kRegions{
    {{"", "", "", ""},
     {"_mask", "", " on the object", ", over the pixels that show mirrors, metals or dielectrics"},
     {"_shadow", "", " in shadows", ", over the pixels where the medium lies in shadow"}}};

template <std::size_t n>
void add_variants(const Quantity& declared, const std::array<Variant, n>& variants, std::vector<Quantity>& out) {
  for (const Variant& variant : variants) {
    Quantity quantity = declared;
    quantity.name += variant.suffix;
    quantity.label = variant.before + declared.label + variant.after;
    quantity.heading = variant.before + declared.heading + variant.after;
    quantity.doc += variant.doc;
    for (std::string* bound : {&quantity.low, &quantity.high}) {
      if (!bound->empty()) *bound += variant.suffix;
    }
    out.push_back(std::move(quantity));
  }
}

std::shared_ptr<Expression> read_expression(TableReader& reader, const std::string& key) {
  std::string text;
  reader.text(key, text, Need::required);
  try {
    return std::make_shared<Expression>(text);
  } catch (const InputError& e) {
    reader.fail(key, e.what());
  }
}

void read_expressions(TableReader& reader, Quantity& quantity) {
  const toml::node* node = reader.node("expression");
  if (node == nullptr) return;
  if (!node->is_table()) {
    quantity.expressions[""] = read_expression(reader, "expression");
    return;
  }
  TableReader by_technique = *reader.table("expression");
  for (const std::string& technique : by_technique.keys())
    quantity.expressions[technique] = read_expression(by_technique, technique);
}

}  // namespace

const char* name(Better better) {
  return better == Better::less ? "less" : better == Better::more ? "more" : "neither";
}

std::string label_with_unit(const Quantity& quantity) {
  return quantity.unit.empty() ? quantity.label : fmt::format("{} [{}]", quantity.label, quantity.unit);
}

std::vector<Quantity> read_quantities(TableReader& root, bool own) {
  std::vector<Quantity> found;
  for (auto& [name, reader] : root.named_tables("quantities")) {
    Quantity quantity;
    quantity.name = name;
    reader.text("label", quantity.label, Need::required);
    reader.text("unit", quantity.unit);
    reader.text("heading", quantity.heading);
    if (quantity.heading.empty()) quantity.heading = label_with_unit(quantity);
    reader.text("doc", quantity.doc, own ? Need::optional : Need::required);
    double digits = quantity.digits;
    reader.integer("digits", digits, {1, 17});
    quantity.digits = static_cast<int>(digits);
    quantity.better = static_cast<Better>(reader.choice("better", {"neither", "less", "more"}, 0));
    reader.boolean("text", quantity.text);
    reader.boolean("time", quantity.time);
    reader.boolean("from_zero", quantity.from_zero);
    if (!own) reader.boolean("identity", quantity.identity);
    if (const auto bounds = reader.texts("bounds"); !bounds.empty()) {
      if (bounds.size() != 2) reader.fail("bounds", "two quantities, the lower first");
      quantity.low = bounds[0].first;
      quantity.high = bounds[1].first;
      reader.text("interval", quantity.interval, Need::required);
    }
    read_expressions(reader, quantity);
    if (own && quantity.expressions.empty()) reader.require("expression");
    bool statistics = false, regions = false;
    reader.boolean("statistics", statistics);
    reader.boolean("regions", regions);
    reader.finish();
    if (statistics) {
      add_variants(quantity, kStatistics, found);
    } else if (regions) {
      add_variants(quantity, kRegions, found);
    } else {
      found.push_back(std::move(quantity));
    }
  }
  return found;
}

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> all = [] {
    std::vector<Quantity> found;
    std::vector<std::string> files{std::string(kOwnFile)};
    const std::vector<std::string> of_techniques = list_resources("algorithms/", "/quantities.toml");
    files.insert(files.end(), of_techniques.begin(), of_techniques.end());
    for (const std::string& name : files) {
      const TomlFile file{name};
      const std::optional<std::string> text = find_resource(name);
      assert(text && "gl/CMakeLists.txt embeds the declarations");
      const auto document = parse_toml(*text, file);
      TableReader root(file, *document);
      for (Quantity& quantity : read_quantities(root, false)) {
        if (name != kOwnFile) quantity.module = std::filesystem::path(name).parent_path().filename().string();
        const bool twice =
            std::any_of(found.begin(), found.end(), [&](const Quantity& other) { return other.name == quantity.name; });
        if (twice) throw InputError(fmt::format("{}: the quantity {} is declared already", name, quantity.name));
        found.push_back(std::move(quantity));
      }
      root.finish();
    }
    return found;
  }();
  return all;
}

const Quantity* find_quantity(std::string_view name) {
  static const std::map<std::string, const Quantity*, std::less<>> by_name = [] {
    std::map<std::string, const Quantity*, std::less<>> index;
    for (const Quantity& quantity : quantities())
      index[quantity.name] = &quantity;
    return index;
  }();
  const auto found = by_name.find(name);
  return found == by_name.end() ? nullptr : found->second;
}

std::optional<double> value_of(const Quantity& quantity, const nlohmann::json& row) {
  if (quantity.expressions.empty()) return number(row, quantity.name);
  auto found = quantity.expressions.find(text(row, "technique"));
  if (found == quantity.expressions.end()) found = quantity.expressions.find("");
  if (found == quantity.expressions.end()) return std::nullopt;
  std::map<std::string, double> values;
  for (const std::string& field : found->second->used()) {
    const auto value = number_or_flag(row, field);
    if (!value) return std::nullopt;
    values[field] = *value;
  }
  const double result = found->second->value(values);
  return std::isfinite(result) ? std::optional(result) : std::nullopt;
}

}  // namespace pellucid::sweeps
