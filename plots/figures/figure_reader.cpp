#include "plots/figures/figure_reader.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <tuple>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "algorithms/parameters.hpp"
#include "algorithms/technique.hpp"

namespace pellucid::plots {
namespace {

constexpr std::size_t kMostSlabs = 8;  // as many as there are colours

std::vector<std::string> words(TableReader& reader, std::string_view key, Need need = Need::optional) {
  std::vector<std::string> found;
  for (auto& [text, place] : reader.texts(key, need))
    found.push_back(text);
  return found;
}

/// The field is a quantity of the paper or of all, or a parameter.
void check_field(const TableReader& reader, std::string_view key, const std::string& field,
                 const sweeps::Paper& paper) {
  if (field.empty() || field.find('.') != std::string::npos || paper.find_quantity(field) != nullptr) return;
  std::vector<std::string> names;
  for (const TechniqueInfo& technique : techniques()) {
    if (technique.table().find(field) != nullptr) return;
    for (const ParameterInfo& info : technique.table().infos())
      names.push_back(info.name);
  }
  for (const sweeps::Quantity& quantity : sweeps::quantities())
    names.push_back(quantity.name);
  for (const sweeps::Quantity& quantity : paper.quantities)
    names.push_back(quantity.name);
  const std::string near = nearest_name(field, names);
  reader.fail(key, fmt::format("'{}' is neither a quantity nor a parameter{}", field,
                               near.empty() ? "; pellucid list quantities names the former"
                                            : fmt::format("; did you mean '{}'?", near)));
}

std::vector<std::string> fields(TableReader& reader, std::string_view key, const sweeps::Paper& paper) {
  const std::vector<std::string> found = words(reader, key);
  for (const std::string& field : found)
    check_field(reader, key, field, paper);
  return found;
}

void read_field(TableReader& reader, std::string_view key, std::string& field, const sweeps::Paper& paper,
                Need need = Need::optional) {
  reader.text(key, field, need);
  check_field(reader, key, field, paper);
}

/// `x = "hulls"`, or a table with the field's label, unit and scale.
AxisWish read_axis(TableReader& reader, const std::string& key, ScaleWish scale, const sweeps::Paper& paper) {
  AxisWish axis;
  axis.scale = scale;
  const toml::node* node = reader.node(key, Need::required);
  if (!node->is_table()) {
    read_field(reader, key, axis.field, paper);
    return axis;
  }
  TableReader table = *reader.table(key);
  read_field(table, "field", axis.field, paper, Need::required);
  table.text("label", axis.label);
  table.text("unit", axis.unit);
  if (table.has("scale")) {
    constexpr ScaleWish kScales[] = {ScaleWish::linear, ScaleWish::automatic, ScaleWish::log, ScaleWish::log2,
                                     ScaleWish::log10};
    axis.scale = kScales[table.choice("scale", {"linear", "automatic", "log", "log2", "log10"}, 0)];
  }
  table.finish();
  return axis;
}

std::string value_of(TableReader& reader, const std::string& key, const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* integer = node.as_integer()) return fmt::format("{}", integer->get());
  if (const auto* real = node.as_floating_point()) return fmt::format("{}", real->get());
  if (const auto* boolean = node.as_boolean()) return boolean->get() ? "true" : "false";
  reader.fail(key, "a value or a list of values");
}

/// Groups such as `scene` and `shadow` are tables of fields.
void read_where(TableReader& reader, const std::string& prefix, std::vector<Where>& out) {
  for (const std::string& key : reader.keys()) {
    const toml::node& node = *reader.node(key);
    if (node.is_table()) {
      TableReader group = *reader.table(key);
      read_where(group, fmt::format("{}{}.", prefix, key), out);
      continue;
    }
    Where& where = out.emplace_back();
    where.field = prefix + key;
    if (const toml::array* list = node.as_array()) {
      for (const toml::node& item : *list)
        where.values.push_back(value_of(reader, key, item));
      if (where.values.empty()) reader.fail(key, "an empty list meets no row");
    } else {
      where.values.push_back(value_of(reader, key, node));
    }
  }
}

std::vector<Where> read_where(TableReader& reader) {
  std::vector<Where> out;
  if (auto table = reader.table("where")) read_where(*table, "", out);
  return out;
}

void read_chart(TableReader& reader, const sweeps::Paper& paper, RowChart& chart) {
  chart.x = read_axis(reader, "x", ScaleWish::automatic, paper);
  chart.y = read_axis(reader, "y", ScaleWish::linear, paper);
  chart.series = words(reader, "series");
  read_field(reader, "lines", chart.lines, paper);
  chart.labels = reader.choice("labels", {"all", "unusual"}, 0) == 0 ? Labels::all : Labels::unusual;
  chart.join = static_cast<Join>(reader.choice("join", {"all", "best", "front"}, 0));
  read_field(reader, "order_by", chart.order_by, paper, chart.join == Join::front ? Need::required : Need::optional);
  if (chart.join != Join::front && reader.has("order_by")) reader.fail("order_by", "goes with join = \"front\"");
  chart.join_note = chart.join == Join::best    ? "Joined: the best at each abscissa; faint: the others."
                    : chart.join == Join::front ? "Joined: those that none beats in both; faint: the others."
                                                : "";
  reader.text("join_note", chart.join_note);
  if (const auto bars = fields(reader, "bars", paper); !bars.empty()) {
    if (bars.size() != 2) reader.fail("bars", "two fields, the lower end first");
    chart.bar_low = bars[0];
    chart.bar_high = bars[1];
    reader.text("bars_note", chart.bars_note, Need::required);
  }
  reader.boolean("reference_error", chart.reference_error);
}

PlaneMark read_mark(TableReader& reader, const sweeps::Paper& paper, const std::vector<PlaneMark>& before) {
  PlaneMark mark;
  reader.text("label", mark.label, Need::required);
  reader.exclude("at", "best");
  if (auto at = reader.table("at")) {
    for (const std::string& field : at->keys()) {
      double value = 0;
      at->number(field, value, {-1e300, 1e300});
      mark.at.emplace_back(field, value);
    }
    if (mark.at.empty()) reader.fail("at", "names the fields of the plane");
  } else {
    read_field(reader, "best", mark.best, paper, Need::required);
    read_field(reader, "no_worse_in", mark.no_worse_in, paper, reader.has("than") ? Need::required : Need::optional);
    reader.text("than", mark.than, reader.has("no_worse_in") ? Need::required : Need::optional);
    const bool known = std::any_of(before.begin(), before.end(), [&](const auto& m) { return m.label == mark.than; });
    if (!mark.than.empty() && !known)
      reader.fail("than", fmt::format("no mark '{}' stands before this one", mark.than));
  }
  reader.text("note", mark.note);
  reader.finish();
  return mark;
}

void read_map(TableReader& reader, const sweeps::Paper& paper, PlaneMap& map) {
  map.x = read_axis(reader, "x", ScaleWish::linear, paper);
  map.y = read_axis(reader, "y", ScaleWish::linear, paper);
  map.value = read_axis(reader, "value", ScaleWish::linear, paper);
  for (TableReader& mark : reader.tables("marks"))
    map.marks.push_back(read_mark(mark, paper, map.marks));
}

// slab = { depths = [1, 2], anisotropy = 0.8, albedo = 1, show = "transmission", polar = false }
void read_slabs(TableReader reader, SlabChart& chart) {
  const toml::array* depths = reader.node("depths", Need::required)->as_array();
  if (depths == nullptr || depths->empty() || depths->size() > kMostSlabs)
    reader.fail("depths", fmt::format("a list of one to {} optical thicknesses", kMostSlabs));
  for (const toml::node& depth : *depths) {
    const double value = depth.value<double>().value_or(-1);
    if (!(value >= 0 && value <= 1e4)) reader.fail("depths", "an optical thickness is a number from 0 to 10000");
    chart.depths.push_back(value);
  }
  reader.number("anisotropy", chart.medium.anisotropy, {-0.98, 0.98}, Need::required);
  reader.number("albedo", chart.medium.albedo, {0, 1});
  chart.show = static_cast<SlabChart::Show>(reader.choice("show", {"transmission", "reflection"}, 0));
  reader.boolean("polar", chart.polar);
  reader.finish();
}

}  // namespace

Figure read_figure(const sweeps::PaperEntry& entry) {
  TableReader reader = sweeps::read_entry(entry, "figures");
  Figure figure;
  figure.paper = entry.paper;
  figure.name = entry.name;
  figure.full_name = entry.full_name();
  std::string name;
  reader.text("name", name);  // read_entry found it by that
  reader.text("title", figure.title, Need::required);
  figure.doc = figure.title;
  reader.text("doc", figure.doc);
  if (auto slabs = reader.table("slab")) {
    SlabChart& chart = figure.drawing.emplace<SlabChart>();
    chart.title = figure.title;
    read_slabs(*slabs, chart);
    reader.finish();
    return figure;
  }
  if (entry.paper->sweeps.size() == 1) figure.sweep = entry.paper->sweeps.front().name;
  reader.text("sweep", figure.sweep, figure.sweep.empty() ? Need::required : Need::optional);
  const auto known = std::any_of(entry.paper->sweeps.begin(), entry.paper->sweeps.end(),
                                 [&](const sweeps::PaperSweep& sweep) { return sweep.name == figure.sweep; });
  if (!known) reader.fail("sweep", fmt::format("'{}' is none of the paper's sweeps", figure.sweep));
  if (reader.has("value")) {
    read_map(reader, *entry.paper, figure.drawing.emplace<PlaneMap>());
  } else {
    read_chart(reader, *entry.paper, figure.drawing.emplace<RowChart>());
    std::get<RowChart>(figure.drawing).colours = entry.paper->colours;
  }
  const auto read_rows = [&](auto& drawing) {
    drawing.title = figure.title;
    drawing.needs = fields(reader, "needs", *entry.paper);
    drawing.where = read_where(reader);
  };
  if (auto* map = std::get_if<PlaneMap>(&figure.drawing))
    read_rows(*map);
  else
    read_rows(std::get<RowChart>(figure.drawing));
  reader.finish();
  return figure;
}

}  // namespace pellucid::plots
