#pragma once

#include <span>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "algorithms/parameters.hpp"

/// Declarations of parameters as JSON: what `describe --json` prints, and what the viewer's renderer tells of a scene.
namespace pellucid::sandbox {

nlohmann::ordered_json parameters_json(std::span<const ParameterInfo>);

/// Reads back what parameters_json() wrote; throws nlohmann::json::exception for anything else.
std::vector<ParameterInfo> parameters_from_json(const nlohmann::json&);

}  // namespace pellucid::sandbox
