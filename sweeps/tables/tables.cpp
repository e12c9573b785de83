#include "sweeps/tables/tables.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "sweeps/store/rows.hpp"
#include "sweeps/tables/table_fill.hpp"
#include "sweeps/tables/table_spec.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;

/// Those of a device or driver with this in its name, and those that failed before they had one.
RowPointers of_device(const TableInfo& info, const RowPointers& rows, std::string_view device) {
  RowPointers kept;
  bool any = false;
  for (const json* row : rows) {
    const std::string name = machine(*row);
    const bool wanted = name.find(device) != std::string::npos;
    any = any || wanted;
    if (wanted || name.empty()) kept.push_back(row);
  }
  if (!any) {
    throw InputError(fmt::format("no row of {} is of a device or driver with '{}' in its name; there are: '{}'",
                                 info.spec, device, fmt::join(machines(rows), "', '")));
  }
  return kept;
}

SweepRows choose_rows(const TableInfo& info, const std::vector<json>& rows, std::string_view device) {
  SweepRows chosen = rows_of_sweep(rows, info.spec);
  if (chosen.rows.empty()) return chosen;
  if (!device.empty()) chosen.rows = of_device(info, chosen.rows, device);
  if (const auto names = machines(chosen.rows); names.size() > 1) {
    throw InputError(
        fmt::format("{} has rows of {} devices or drivers, which are never pooled: '{}'; choose one with "
                    "--device-name",
                    chosen.sweep, names.size(), fmt::join(names, "', '")));
  }
  return chosen;
}

}  // namespace

std::vector<TableInfo> tables() {
  std::vector<TableInfo> infos;
  for (const PaperEntry& entry : built_in_entries("tables"))
    infos.push_back(read_table_spec(entry).info);
  return infos;
}

TableInfo find_table(std::string_view name) {
  return find_table(find_entry(name, "tables", "table"));
}

TableInfo find_table(const PaperEntry& entry) {
  return read_table_spec(entry).info;
}

Table make_table(std::string_view name, const std::vector<json>& rows, std::string_view device) {
  return make_table(find_entry(name, "tables", "table"), rows, device);
}

Table make_table(const PaperEntry& entry, const std::vector<json>& rows, std::string_view device) {
  const TableSpec spec = read_table_spec(entry);
  const SweepRows chosen = choose_rows(spec.info, rows, device);
  const std::vector<FilledGroup> groups = fill_groups(spec, chosen);
  const bool ours =
      std::any_of(groups.begin(), groups.end(), [](const FilledGroup& group) { return !group.used.empty(); });
  Table table;
  table.info = spec.info;
  table.heading_rows = spec.heading_rows;
  table.sweep = ours ? chosen.sweep : "";
  table.rows = lay_out(spec, groups);
  table.records = make_records(spec, groups, table.sweep);
  table.notes = make_notes(spec, groups, table.sweep);
  return table;
}

}  // namespace pellucid::sweeps
