#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "algorithms/scene/scene.hpp"

/// What several sub-commands tell of a scene.
namespace pellucid::sandbox {

/// The scene's volume in numbers: `voxels`, `voxel_spacing_m`, `extinction_per_m`, and `file_range`, the values in its
/// file that became density 0 and 1 (null where it comes from none). Null without a volume.
nlohmann::ordered_json volume_json(const Scene&);
/// The same as one line of words; empty without a volume.
std::string volume_text(const Scene&);

}  // namespace pellucid::sandbox
