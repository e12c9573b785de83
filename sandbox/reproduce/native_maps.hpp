#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "algorithms/technique.hpp"

/// A technique's errors by pixel, as files.
namespace pellucid::sandbox {

/// The names of the techniques that tell their errors by pixel: "a, b".
std::string techniques_with_maps();

/// Throws InputError unless the technique is one of them, RuntimeError when `folder` is something else than a folder.
void check_maps(const TechniqueInfo&, const std::filesystem::path& folder);

/// Writes FOLDER/NAME.exr with the values (one channel, 32 bits, not-a-number without a value) and FOLDER/NAME.png in
/// colours for each map; the folder is made where it is missing. Returns for each name its `unit`, `doc`, `width`,
/// `height`, `range` (what the brightest colour stands for), `max`, `exr` and `png`.
/// Throws InputError when no pixel of any map has a value, RuntimeError when a file cannot be written.
nlohmann::ordered_json write_maps(const std::filesystem::path& folder, const std::vector<NativeMap>&,
                                  const Attributes&);

/// One line for each map of what write_maps() returned.
std::string maps_text(const nlohmann::ordered_json& written);

}  // namespace pellucid::sandbox
