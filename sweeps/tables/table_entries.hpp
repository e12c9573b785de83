#pragma once

#include <string>
#include <vector>

#include "sweeps/tables/table_spec.hpp"

/// The columns, groups, families and rows of a table, as the file gives them. For table_spec.cpp alone.
namespace pellucid::sweeps {

/// Every combination of the lists in one table of the file; `name`, `with` and `any` apart, its keys are fields.
std::vector<TableEntry> read_combinations(TableReader&);

/// A list of tables, or one table. `default_name`: the template of those that have no `name`.
std::vector<TableEntry> read_entries(TableReader& reader, const std::string& key, const std::string& default_name);

/// `where` and `with` of a whole table.
void read_where(TableReader& reader, TableEntry& entry);

/// Appends the lines of `rows`, those of the sets that it names put in their places. Columns, groups and families must
/// be there.
void read_lines(TableReader& reader, TableReader& root, TableSpec&);

/// A family's name under `key`; it must be one of the table's.
void read_family(TableReader& reader, const char* key, const TableSpec&, std::string& family);

}  // namespace pellucid::sweeps
