#include "sweeps/tables.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "sweeps/table_rows.hpp"

namespace pellucid::sweeps {
namespace {

using Make = Table (*)(const TableInfo&, const ChosenRows&);

struct Entry {
  TableInfo info;
  Make make;
};

// One line for each published table.
const std::vector<Entry>& entries() {
  static const std::vector<Entry> all{{sampling_hulls_table1_info(), &sampling_hulls_table1}};
  return all;
}

const Entry& find_entry(std::string_view name) {
  std::vector<std::string> names;
  for (const Entry& entry : entries()) {
    if (entry.info.name == name) return entry;
    names.push_back(entry.info.name);
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
