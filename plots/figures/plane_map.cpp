#include "plots/figures/plane_map.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"

namespace pellucid::plots {
namespace {

using nlohmann::json;

void check_one_setting(const Rows& rows, const std::array<std::string, 2>& plane) {
  const std::vector<Group> groups = group_rows(rows, plane);
  check_distinct(groups, plane);
  if (groups.size() < 2) return;
  throw InputError(
      fmt::format("a map shows one setting beside {} and {}, the rows have {}: '{}', '{}'{}; choose with --where",
                  plane[0], plane[1], groups.size(), groups[0].label, groups[1].label, groups.size() > 2 ? ", …" : ""));
}

/// The first is larger where more is better, smaller elsewhere.
bool better(const Fields& fields, const std::string& field, double a, double b) {
  const Quantity* quantity = fields.find(field);
  return quantity != nullptr && quantity->better == sweeps::Better::more ? a > b : a < b;
}

/// The row of a mark, and the bound that it had to keep.
struct Marked {
  const json* row = nullptr;
  std::optional<double> bound{};
};

/// Null where a row lacks what decides.
Marked best_row(const Rows& rows, const PlaneMark& mark, const json* than, const Fields& fields) {
  Marked found;
  if (!mark.than.empty()) {
    if (than == nullptr) return {};
    found.bound = fields.value(*than, mark.no_worse_in);
    if (!found.bound) return {};
  }
  std::optional<double> best;
  for (const json* row : rows.kept) {
    const auto decides = fields.value(*row, mark.best);
    const auto held = mark.than.empty() ? std::optional(0.0) : fields.value(*row, mark.no_worse_in);
    if (!decides || !held) return {};
    const bool keeps = !found.bound || *held == *found.bound || better(fields, mark.no_worse_in, *held, *found.bound);
    if (!keeps || (best && !better(fields, mark.best, *decides, *best))) continue;
    best = decides;
    found.row = row;
  }
  return found;
}

const json* row_at(const Rows& rows, const PlaneMark& mark, const Fields& fields) {
  const auto stands = [&](const json* row) {
    return std::all_of(mark.at.begin(), mark.at.end(),
                       [&](const auto& place) { return fields.value(*row, place.first) == place.second; });
  };
  const auto found = std::find_if(rows.kept.begin(), rows.kept.end(), stands);
  return found == rows.kept.end() ? nullptr : *found;
}

/// The note with what stands in braces filled in.
std::string fill(const std::string& note, const Marked& marked) {
  std::string out;
  for (std::size_t i = 0; i < note.size(); ++i) {
    const std::size_t end = note[i] == '{' ? note.find('}', i) : std::string::npos;
    if (end == std::string::npos) {
      out += note[i];
      continue;
    }
    const std::string field = note.substr(i + 1, end - i - 1);
    out += field == "bound" && marked.bound ? fmt::format("{:.3g}", *marked.bound)
                                            : sweeps::field_text(*marked.row, field);
    i = end;
  }
  return out;
}

}  // namespace

HeatMap map_of_rows(const std::vector<json>& all, const PlaneMap& wanted, const Fields& fields) {
  const std::array<std::string, 2> plane{wanted.x.field, wanted.y.field};
  std::vector<std::string> needed{plane[0], plane[1], wanted.value.field};
  needed.insert(needed.end(), wanted.needs.begin(), wanted.needs.end());
  const Rows rows = choose_rows(all, wanted.where, needed, fields);
  check_one_setting(rows, plane);

  std::set<double> columns, lines;
  for (const json* row : rows.kept) {
    columns.insert(*fields.value(*row, plane[0]));
    lines.insert(*fields.value(*row, plane[1]));
  }
  HeatMap map;
  map.title = wanted.title;
  map.x_label = axis_of(wanted.x, fields).label;
  map.y_label = axis_of(wanted.y, fields).label;
  map.value_label = axis_of(wanted.value, fields).label;
  for (const double value : columns)
    map.columns.push_back(fmt::format("{:g}", value));
  for (const double value : lines)
    map.rows.push_back(fmt::format("{:g}", value));
  map.values.assign(lines.size(), std::vector<std::optional<double>>(columns.size()));
  const auto place = [](const std::set<double>& values, double value) {
    return static_cast<std::size_t>(std::distance(values.begin(), values.find(value)));
  };
  const auto cell_of = [&](const json& row) {
    return HeatMap::Cell{place(lines, *fields.value(row, plane[1])), place(columns, *fields.value(row, plane[0]))};
  };
  std::set<double> values;
  for (const json* row : rows.kept) {
    const double value = *fields.value(*row, wanted.value.field);
    const HeatMap::Cell cell = cell_of(*row);
    map.values[cell.row][cell.column] = value;
    values.insert(value);
  }
  map.value_scale = scale_for(*values.begin(), *values.rbegin());

  const auto timed = [&](const std::string& field) { return fields.is_time(field); };
  map.note = provenance_note(rows, std::any_of(needed.begin(), needed.end(), timed));
  std::map<std::string, Marked> marked;
  for (const PlaneMark& mark : wanted.marks) {
    Marked& found = marked[mark.label];
    if (mark.best.empty()) {
      found.row = row_at(rows, mark, fields);
    } else {
      found = best_row(rows, mark, mark.than.empty() ? nullptr : marked.at(mark.than).row, fields);
    }
    if (found.row == nullptr) continue;
    map.marks.push_back({cell_of(*found.row), mark.label});
    if (!mark.note.empty()) map.note.append(" ").append(fill(mark.note, found));
  }
  return map;
}

}  // namespace pellucid::plots
