#include "sweeps/tables/tables.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "sweeps/tables/table_rows.hpp"

namespace pellucid::sweeps {
namespace {

using Make = Table (*)(const TableInfo&, const ChosenRows&);

struct Entry {
  TableInfo info;
  Make make;
};

// One line for each table.
const std::vector<Entry>& entries() {
  static const std::vector<Entry> all{{sampling_hulls_table1_info(), &sampling_hulls_table1},
                                      {sampling_hulls_figure_info(8), &sampling_hulls_fig8},
                                      {sampling_hulls_figure_info(9), &sampling_hulls_fig9},
                                      {sampling_hulls_figure_info(10), &sampling_hulls_fig10},
                                      {sampling_hulls_figure_info(11), &sampling_hulls_fig11},
                                      {sampling_hulls_equal_info(), &sampling_hulls_equal},
                                      {sampling_hulls_shadows_info(), &sampling_hulls_shadows},
                                      {sampling_hulls_references_info(), &sampling_hulls_references},
                                      {distance_impostors_figure_info(5), &distance_impostors_fig5},
                                      {distance_impostors_figure_info(6), &distance_impostors_fig6},
                                      {distance_impostors_figure_info(7), &distance_impostors_fig7},
                                      {distance_impostors_rates_info(), &distance_impostors_rates},
                                      {geocube_table2_info(), &geocube_table2},
                                      {geocube_fig16_info(), &geocube_fig16},
                                      {geocube_bounds_info(), &geocube_bounds}};
  return all;
}

const Entry& find_entry(std::string_view name) {
  std::vector<std::string> names;
  std::vector<const Entry*> short_named;  // "fig8" for "sampling_hulls.fig8"
  for (const Entry& entry : entries()) {
    if (entry.info.name == name) return entry;
    names.push_back(entry.info.name);
    if (entry.info.name.ends_with(fmt::format(".{}", name))) short_named.push_back(&entry);
  }
  if (short_named.size() == 1) return *short_named.front();
  if (short_named.size() > 1) {
    throw InputError(fmt::format("'{}' is a table of several papers: {}, {}{}", name, short_named[0]->info.name,
                                 short_named[1]->info.name, short_named.size() > 2 ? ", …" : ""));
  }
  const std::string near = nearest_name(name, names);
  throw InputError(near.empty() ? fmt::format("no table named '{}'; there are: {}", name, fmt::join(names, ", "))
                                : fmt::format("no table named '{}'; did you mean '{}'?", name, near));
}

}  // namespace

std::vector<TableInfo> tables() {
  std::vector<TableInfo> infos;
  for (const Entry& entry : entries())
    infos.push_back(entry.info);
  return infos;
}

TableInfo find_table(std::string_view name) {
  return find_entry(name).info;
}

Table make_table(std::string_view name, const std::vector<nlohmann::json>& rows, std::string_view device) {
  const Entry& entry = find_entry(name);
  return entry.make(entry.info, choose_rows(entry.info, rows, device));
}

}  // namespace pellucid::sweeps
