#pragma once

#include <nlohmann/json_fwd.hpp>

#include "algorithms/parameters.hpp"
#include "sweeps/spec/plan.hpp"

/// A point and its values as JSON: for the worker, for rows and for `--json`.
namespace pellucid::sweeps {

nlohmann::json point_to_json(const Point&);
/// Throws RuntimeError when a field is missing or of another type.
Point point_from_json(const nlohmann::json&);

nlohmann::json value_to_json(const Value&);
/// A number without a fraction becomes an integer; checked() makes it a real where that is asked for.
Value value_from_json(const nlohmann::json&);

}  // namespace pellucid::sweeps
