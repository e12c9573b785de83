#include "sweeps/tables/table_fill.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;
using Fields = std::vector<std::pair<std::string, std::vector<std::string>>>;

/// Fields and the texts of the values they may have; a later entry's takes the place of an earlier one's.
Fields fields_of(std::initializer_list<const TableEntry*> entries, const Variables& variables) {
  Fields fields;
  for (const TableEntry* entry : entries) {
    for (const auto& [field, values] : entry->where) {
      auto found =
          std::find_if(fields.begin(), fields.end(), [&field = field](const auto& f) { return f.first == field; });
      if (found == fields.end()) found = fields.insert(found, {field, {}});
      found->second.clear();
      for (const Value& value : values) {
        const auto* text = std::get_if<std::string>(&value);
        found->second.push_back(text != nullptr ? expand(*text, variables) : to_text(value));
      }
    }
  }
  return fields;
}

bool meets_all(const json& row, const Fields& fields) {
  return std::all_of(fields.begin(), fields.end(), [&](const auto& field) {
    return std::any_of(field.second.begin(), field.second.end(), [&](const std::string& value) {
      return meets(row, {field.first, value});
    });
  });
}

const json* find_row(const SweepRows& rows, const Fields& fields) {
  const json* found = nullptr;
  for (const json* row : rows.rows) {
    if (!meets_all(*row, fields)) continue;
    // A point that stands in two blocks of its spec is one measurement.
    const std::string point = text(*row, "point");
    if (found != nullptr && (point.empty() || point != text(*found, "point"))) {
      std::vector<std::string> place;
      for (const auto& [field, values] : fields)
        place.push_back(fmt::format("{} = {}", field, fmt::join(values, " or ")));
      throw InputError(fmt::format("{} has two rows for {}: {}; a table shows one", rows.sweep, fmt::join(place, ", "),
                                   difference(*found, *row)));
    }
    found = row;
  }
  return found;
}

std::optional<double> ratio(std::optional<double> over, std::optional<double> under) {
  return over && under && *under > 0 ? std::optional(*over / *under) : std::nullopt;
}

std::string number_text(double value, const TableLine& line, const Quantity& quantity) {
  if (line.decimals) return fmt::format("{:.{}f}", value, *line.decimals);
  return significant(value, line.digits.value_or(quantity.digits));
}

/// One group in the making.
class GroupFiller {
 public:
  GroupFiller(const TableSpec& spec, const SweepRows& rows, std::size_t group)
      : spec_(spec), rows_(rows), group_(spec.groups[group]), number_(group) {
    out_.variables = merged(spec.all.variables, group_.variables);
    out_.name = expand(group_.name, out_.variables);
    out_.places = places(spec.family);
    by_family_[spec.family] = out_.places;
  }

  FilledGroup fill() {
    for (const TableLine& line : spec_.lines)
      out_.lines.push_back(fill(line));
    return std::move(out_);
  }

 private:
  std::vector<TablePlace> places(const std::string& family) {
    std::vector<TablePlace> found;
    for (const TableEntry& column : spec_.columns) {
      Variables variables = merged(out_.variables, column.variables);
      std::string name = expand(column.name, variables);
      name.erase(0, name.find_first_not_of(' '));
      if (!out_.name.empty()) name += fmt::format(" ({})", out_.name);
      Fields fields;
      if (family.empty()) {
        fields = fields_of({&spec_.all, &group_, &column}, variables);
      } else {
        const TableEntry& named = spec_.families.find(family)->second;
        variables = merged(variables, named.variables);
        fields = fields_of({&spec_.all, &group_, &column, &named}, variables);
      }
      const json* row = find_row(rows_, fields);
      if (row != nullptr && std::find(out_.used.begin(), out_.used.end(), row) == out_.used.end())
        out_.used.push_back(row);
      found.push_back({std::move(name), row, outcome(row)});
    }
    return found;
  }

  const std::vector<TablePlace>& places_of(const std::string& family) {
    const auto found = by_family_.find(family);
    return found != by_family_.end() ? found->second : by_family_[family] = places(family);
  }

  FilledLine fill(const TableLine& line) {
    FilledLine filled{&line, label_of(line), nullptr, {}, {}, {}, {}};
    switch (line.kind) {
      case TableLine::Kind::show:
        for (const TableEntry& column : spec_.columns)
          filled.ours.push_back(shown(line, column));
        return filled;
      case TableLine::Kind::outcome:
        for (const TablePlace& place : out_.places)
          filled.ours.push_back({place.outcome, std::nullopt});
        return filled;
      case TableLine::Kind::quantity:
        break;
    }
    filled.quantity = &quantity_of(line);
    fill_ours(filled);
    fill_paper(filled);
    return filled;
  }

  const Quantity& quantity_of(const TableLine& line) const {
    return spec_.entry.paper->quantity(expand(line.quantity, out_.variables));
  }

  std::string label_of(const TableLine& line) const {
    if (!line.label.empty()) return expand(line.label, out_.variables);
    std::string label = quantity_of(line).heading;
    if (line.relative_to.empty()) return label;
    const TableEntry& column = spec_.columns[line.relative_to.front().value_or(0)];
    return fmt::format("{} relative to {}", label, expand(column.name, merged(out_.variables, column.variables)));
  }

  TableCell shown(const TableLine& line, const TableEntry& column) const {
    Variables variables = merged(out_.variables, column.variables);
    variables["name"] = expand(column.name, variables);
    const bool one_variable = line.show.find('{') == std::string::npos;
    if (one_variable && !variables.contains(line.show)) return {"", std::nullopt};  // other columns have it
    const Value value = expand_value(one_variable ? fmt::format("{{{}}}", line.show) : line.show, variables);
    TableCell cell{to_text(value), std::nullopt};
    if (const auto* whole = std::get_if<std::int64_t>(&value)) cell.value = static_cast<double>(*whole);
    if (const auto* real = std::get_if<double>(&value)) cell.value = *real;
    return cell;
  }

  void fill_ours(FilledLine& filled) {
    const TableLine& line = *filled.line;
    const Quantity& quantity = *filled.quantity;
    const std::vector<TablePlace> from = places_of(line.family.empty() ? spec_.family : line.family);
    const auto value = [&](const TablePlace& place, const Quantity& of) {
      return place.measured() ? value_of(of, *place.row) : std::nullopt;
    };
    std::vector<TablePlace> under;
    if (!line.over.empty()) under = places_of(line.over);
    for (std::size_t i = 0; i < from.size(); ++i) {
      std::optional<double> number = value(from[i], quantity);
      if (!under.empty()) number = ratio(number, value(under[i], quantity));
      if (!line.relative_to.empty())
        number = line.relative_to[i] ? ratio(number, value(from[*line.relative_to[i]], quantity)) : std::nullopt;
      const bool failed = from[i].outcome == "failed" || (!under.empty() && under[i].outcome == "failed");
      const bool due = line.relative_to.empty() || line.relative_to[i];
      TableCell cell{failed && due ? "failed" : "", number};
      if (number) cell.text = number_text(*number, line, quantity);
      if (number && quantity.time && !line.is_ratio() && from[i].outcome == "unconverged") cell.text += "†";
      filled.ours.push_back(std::move(cell));
    }
    if (!line.interval) return;
    const Quantity& low = spec_.entry.paper->quantity(quantity.low);
    const Quantity& high = spec_.entry.paper->quantity(quantity.high);
    for (const TablePlace& place : from) {
      for (const auto& [cells, bound] : {std::pair{&filled.low, &low}, std::pair{&filled.high, &high}}) {
        const auto number = value(place, *bound);
        cells->push_back({place.outcome == "failed" ? "failed"
                          : number                  ? number_text(*number, line, *bound)
                                                    : "",
                          number});
      }
    }
  }

  void fill_paper(FilledLine& filled) const {
    const TableLine& line = *filled.line;
    std::vector<Published> row;
    if (!line.published.empty()) {
      row = line.published[line.published.size() > 1 ? number_ : 0];
    } else if (!line.relative_to.empty()) {
      row = relative_of_paper(line);
    }
    for (const Published& published : row) {
      TableCell cell{"", published.value()};
      if (published.low && published.is_range()) {
        cell.text = fmt::format("{} to {}", *published.low, *published.high);
      } else if (published.low) {
        cell.text =
            line.decimals ? fmt::format("{:.{}f}", *published.low, *line.decimals) : fmt::format("{}", *published.low);
      }
      filled.paper.push_back(std::move(cell));
    }
  }

  /// The published values of the same quantity, where an earlier line gives them.
  std::vector<Published> relative_of_paper(const TableLine& line) const {
    const auto source = std::find_if(spec_.lines.begin(), spec_.lines.end(), [&](const TableLine& other) {
      return !other.published.empty() && !other.is_ratio() && other.quantity == line.quantity;
    });
    if (source == spec_.lines.end()) return {};
    const std::vector<Published>& values = source->published[source->published.size() > 1 ? number_ : 0];
    std::vector<Published> row;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto value =
          line.relative_to[i] ? ratio(values[i].value(), values[*line.relative_to[i]].value()) : std::nullopt;
      row.push_back({value, value});
    }
    return row;
  }

  const TableSpec& spec_;
  const SweepRows& rows_;
  const TableEntry& group_;
  std::size_t number_;
  FilledGroup out_;
  std::map<std::string, std::vector<TablePlace>> by_family_;
};

}  // namespace

std::vector<FilledGroup> fill_groups(const TableSpec& spec, const SweepRows& rows) {
  std::vector<FilledGroup> groups;
  for (std::size_t i = 0; i < spec.groups.size(); ++i) {
    FilledGroup group = GroupFiller(spec, rows, i).fill();
    const bool empty =
        std::none_of(group.places.begin(), group.places.end(), [](const TablePlace& p) { return p.row != nullptr; });
    // A preview may have fewer groups.
    if (!(empty && spec.skip_empty_groups && !rows.rows.empty())) groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace pellucid::sweeps
