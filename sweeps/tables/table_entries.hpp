#pragma once

#include <string>
#include <vector>

#include "sweeps/tables/table_spec.hpp"

/// The columns, groups and families of a table, as the file gives them. For table_spec.cpp alone.
namespace pellucid::sweeps {

/// Every combination of the lists in one table of the file; `name`, `with` and `any` apart, its keys are fields.
std::vector<TableEntry> read_combinations(TableReader&);

/// A list of tables, or one table. `default_name`: the template of those that have no `name`.
std::vector<TableEntry> read_entries(TableReader& reader, const std::string& key, const std::string& default_name);

/// `where` and `with` of a whole table.
void read_where(TableReader& reader, TableEntry& entry);

}  // namespace pellucid::sweeps
