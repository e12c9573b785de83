// A filled table as records for JSON.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sweeps/tables/table_fill.hpp"

namespace pellucid::sweeps {
namespace {

std::optional<Value> optional_value(std::optional<double> value) {
  return value ? std::optional<Value>(*value) : std::nullopt;
}

const FilledLine* find_line(const FilledGroup& group, std::string_view id) {
  for (const FilledLine& line : group.lines) {
    if (line.quantity != nullptr && line.line->id == id) return &line;
  }
  return nullptr;
}

/// `quantity`, `paper` and `ours`, with their bounds where there are some.
void add_result(const FilledLine& line, const FilledGroup& group, std::size_t column, TableRecord& record) {
  const TableLine& spec = *line.line;
  record.emplace_back("quantity",
                      spec.json_quantity.empty() ? line.quantity->name : expand(spec.json_quantity, group.variables));
  record.emplace_back("paper", line.paper.empty() ? std::nullopt : optional_value(line.paper[column].value));
  for (const auto& row : spec.published) {
    if (std::none_of(row.begin(), row.end(), [](const Published& p) { return p.low && p.is_range(); })) continue;
    record.emplace_back("paper_low", optional_value(row[column].low));
    record.emplace_back("paper_high", optional_value(row[column].high));
    break;
  }
  record.emplace_back("ours", optional_value(line.ours[column].value));
  if (line.low.empty()) return;
  const std::string of = line.quantity->interval.starts_with("95 %") ? "ours_ci95" : "ours";
  record.emplace_back(of + "_low", optional_value(line.low[column].value));
  record.emplace_back(of + "_high", optional_value(line.high[column].value));
}

/// `outcome`, `failure`, `frames`, scene, view, size, device, driver, clock, commit and `sweep`.
void add_origin(const TablePlace& place, const std::string& sweep, TableRecord& record) {
  const auto words = [&](const char* name) -> std::optional<Value> {
    if (place.row == nullptr || text(*place.row, name).empty()) return std::nullopt;
    return text(*place.row, name);
  };
  const auto whole = [&](const char* name) -> std::optional<Value> {
    const auto v = place.row == nullptr ? std::nullopt : number(*place.row, name);
    return v ? std::optional<Value>(static_cast<std::int64_t>(*v)) : std::nullopt;
  };
  record.emplace_back("outcome", place.outcome);
  record.emplace_back("failure", words("failure"));
  record.emplace_back("frames", whole("frames"));
  for (const char* name : {"scene", "view"})
    record.emplace_back(name, words(name));
  for (const char* name : {"width", "height"})
    record.emplace_back(name, whole(name));
  for (const char* name : {"device", "driver", "clock", "commit"})
    record.emplace_back(name, words(name));
  record.emplace_back("sweep", sweep.empty() ? std::nullopt : std::optional<Value>(sweep));
}

/// One record: a line's result in a column.
class RecordMaker {
 public:
  RecordMaker(const TableSpec& spec, const FilledGroup& group, std::size_t column)
      : spec_(spec),
        group_(group),
        column_(column),
        variables_(merged(group.variables, spec.columns[column].variables)) {
    variables_["name"] = expand(spec.columns[column].name, variables_);
    if (!group.name.empty()) variables_["group"] = group.name;
  }

  TableRecord make(const FilledLine& result, const std::string& sweep) const {
    TableRecord record;
    for (const RecordField& field : spec_.json) {
      if (field.source == "result") {
        add_result(result, group_, column_, record);
      } else {
        add(field, record);
      }
    }
    add_origin(group_.places[column_], sweep, record);
    return record;
  }

 private:
  void add(const RecordField& field, TableRecord& record) const {
    const FilledLine* line = find_line(group_, field.source);
    if (const auto found = variables_.find(field.source); found != variables_.end()) {
      const auto* text = std::get_if<std::string>(&found->second);
      record.emplace_back(field.name, text != nullptr ? Value(expand(*text, variables_)) : found->second);
    } else if (line != nullptr && !line->paper.empty() && line->line->is_ratio()) {
      record.emplace_back("paper_" + field.name, optional_value(line->paper[column_].value));
      record.emplace_back("ours_" + field.name, optional_value(line->ours[column_].value));
    } else if (line != nullptr) {
      record.emplace_back(field.name, optional_value(line->ours[column_].value));
    } else {
      const Quantity* quantity = spec_.entry.paper->find_quantity(field.source);
      const TablePlace& place = group_.places[column_];
      const bool here = quantity != nullptr && place.measured();
      record.emplace_back(field.name, here ? optional_value(value_of(*quantity, *place.row)) : std::nullopt);
    }
  }

  const TableSpec& spec_;
  const FilledGroup& group_;
  std::size_t column_;
  Variables variables_;
};

}  // namespace

std::vector<TableRecord> make_records(const TableSpec& spec, const std::vector<FilledGroup>& groups,
                                      const std::string& sweep) {
  std::vector<TableRecord> records;
  for (const FilledGroup& group : groups) {
    for (std::size_t column = 0; column < spec.columns.size(); ++column) {
      const RecordMaker maker(spec, group, column);
      for (const std::string& id : spec.records)
        records.push_back(maker.make(*find_line(group, id), sweep));
    }
  }
  return records;
}

}  // namespace pellucid::sweeps
