#include "sweeps/tables/table_places.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace pellucid::sweeps {
namespace {

using nlohmann::json;

std::vector<std::string> names_of(std::span<const Place> places, std::string_view outcome) {
  std::vector<std::string> names;
  for (const Place& place : places) {
    if (place.outcome == outcome) names.push_back(place.name);
  }
  return names;
}

}  // namespace

Place make_place(std::string name, const json* row) {
  return {std::move(name), row, outcome(row)};
}

TableRow our_row(std::string label, std::span<const Place> places, int digits, const PlaceValue& value, unsigned in) {
  TableRow row{std::move(label), {}, in};
  for (const Place& place : places) {
    TableCell cell;
    if (place.outcome == "failed") {
      cell.text = "failed";
    } else if (place.row != nullptr) {
      cell.value = value(*place.row);
      if (cell.value) cell.text = significant(*cell.value, digits);
    }
    row.cells.push_back(std::move(cell));
  }
  return row;
}

TableRow value_row(std::string label, std::span<const Place> places, int decimals,
                   const std::vector<std::optional<double>>& values) {
  TableRow row{std::move(label), {}, TableRow::all};
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto& value = values.at(i);
    const std::string none = places[i].outcome == "failed" ? "failed" : "";
    row.cells.push_back({value ? fmt::format("{:.{}f}", *value, decimals) : none, value});
  }
  return row;
}

TableRow words_row(std::string label, const std::vector<std::string>& words) {
  TableRow row{std::move(label), {}, TableRow::all};
  for (const std::string& word : words)
    row.cells.push_back({word, std::nullopt});
  return row;
}

TableRow paper_row(std::string label, int decimals, const std::vector<std::optional<double>>& values) {
  TableRow row{std::move(label), {}, TableRow::all};
  for (const auto& value : values)
    row.cells.push_back({value ? fmt::format("{:.{}f}", *value, decimals) : "", value});
  return row;
}

TableRow fps_row(std::string label, std::span<const Place> places) {
  TableRow row = our_row(std::move(label), places, 4, [](const json& r) { return number(r, "fps"); });
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i].outcome == "unconverged") row.cells[i].text += "†";
  }
  return row;
}

std::optional<double> fps(const Place& place) {
  return place.measured() ? number(*place.row, "fps") : std::nullopt;
}

std::optional<double> fps_bound(const json& row, const char* frame_ms) {
  const auto ms = number(row, frame_ms);
  return ms && *ms > 0 ? std::optional(1000 / *ms) : std::nullopt;
}

std::vector<TableRow> interval_rows(std::span<const Place> places) {
  const auto low = [](const json& row) { return fps_bound(row, "frame_ms_ci95_high"); };
  const auto high = [](const json& row) { return fps_bound(row, "frame_ms_ci95_low"); };
  TableRow both = our_row("95 % interval", places, 4, low, TableRow::markdown);
  const TableRow upper = our_row("95 % interval, high", places, 4, high, TableRow::latex | TableRow::csv);
  TableRow lower = both;
  lower.label = "95 % interval, low";
  lower.in = upper.in;
  for (std::size_t i = 0; i < both.cells.size(); ++i) {
    if (both.cells[i].value && upper.cells[i].value) both.cells[i].text += "–" + upper.cells[i].text;
    both.cells[i].value.reset();
  }
  return {both, lower, upper};
}

TableRow outcome_row(std::span<const Place> places) {
  TableRow row{"outcome", {}, TableRow::csv};
  for (const Place& place : places)
    row.cells.push_back({place.outcome, std::nullopt});
  return row;
}

std::vector<std::string> outcome_notes(std::span<const Place> places, bool untimed) {
  std::vector<std::string> notes;
  if (const auto names = names_of(places, "unconverged"); !names.empty()) {
    notes.push_back(
        fmt::format("† unconverged, {} of {} points: the limit of frames or seconds came before the interval "
                    "was as narrow as asked for.",
                    names.size(), places.size()));
  }
  for (const Place& place : places) {
    if (place.outcome == "failed")
      notes.push_back(fmt::format("{} failed: {}", place.name, text(*place.row, "failure")));
  }
  if (const auto names = names_of(places, "untimed"); untimed && !names.empty())
    notes.push_back(fmt::format("Measured without timing: {}.", fmt::join(names, ", ")));
  if (const auto names = names_of(places, "missing"); !names.empty())
    notes.push_back(fmt::format("Not measured yet: {}.", fmt::join(names, ", ")));
  return notes;
}

std::optional<Value> real_value(std::optional<double> value) {
  return value ? std::optional<Value>(*value) : std::nullopt;
}

std::optional<Value> real_field(const Place& place, const char* name) {
  return place.measured() ? real_value(number(*place.row, name)) : std::nullopt;
}

void add_origin(TableRecord& record, const Place& place, const std::string& sweep) {
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

}  // namespace pellucid::sweeps
