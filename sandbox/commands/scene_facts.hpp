#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "algorithms/scene/scene.hpp"

/// The facts that several sub-commands tell of a scene.
namespace pellucid::sandbox {

/// The scene's volume in numbers: `voxels`, `voxel_spacing_m`, `extinction_per_m`, and `file_range`, the values in its
/// file that became density 0 and 1 (null where it comes from none). Null without a volume.
nlohmann::ordered_json volume_json(const Scene&);
/// The same as one line of words; empty without a volume.
std::string volume_text(const Scene&);

/// Throws InputError when `output` is one of the files that the scene was read from.
void check_output_is_no_input(const std::filesystem::path& output, const Scene&);

/// Prints the scene's warnings to standard error, a line each.
void print_warnings(const Scene&);

}  // namespace pellucid::sandbox
