#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

/// Comma-separated values as RFC 4180 has them.
namespace pellucid::sweeps {

/// One record with its CRLF. A field is quoted when it must be.
std::string csv_record(const std::vector<std::string>& fields);

/// A heading and one record for each row of a store (sweeps/store/store.hpp). Columns come in a fixed order: what tells
/// a row apart, parameters and a technique's own errors by name, and the rest as sweeps/quantities/quantities.toml
/// declares it. An object is opened (`pass_ms.fog`), a list is written as JSON. Whatever a row lacks is empty; columns
/// that no row has are left out, but for those that tell rows apart.
std::string rows_to_csv(const std::vector<nlohmann::json>& rows);
/// The same with these columns alone, in their order.
std::string rows_to_csv(const std::vector<nlohmann::json>& rows, const std::vector<std::string>& names);

}  // namespace pellucid::sweeps
