#pragma once

#include <nlohmann/json_fwd.hpp>

#include "algorithms/scene/images/image.hpp"

/// A picture file's statements about itself.
namespace pellucid::sandbox {

/// Where a file comes from: version, commit, time, command line.
nlohmann::ordered_json file_provenance();
/// A file must know this to be made again (`pellucid reproduce FILE.exr`), and where it comes from.
Attributes file_attributes(const char* command, const nlohmann::ordered_json& recipe,
                           const nlohmann::ordered_json& origin);

}  // namespace pellucid::sandbox
