#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pellucid {

/// Text files of the source tree (`.glsl`, `.toml`, `.md` of a module) that are embedded in the binary, so that it runs
/// from anywhere. A name is the path below the source root: "algorithms/sampling_hulls/hull.frag.glsl".
/// With PELLUCID_SHADER_PATH=ROOT a `.glsl` file below ROOT takes precedence over the embedded text.

/// The text of `name`, or nothing when there is no such resource. Throws RuntimeError if an override cannot be read.
std::optional<std::string> find_resource(std::string_view name);

/// Every embedded name that starts with `prefix` and ends with `suffix`, sorted.
std::vector<std::string> list_resources(std::string_view prefix, std::string_view suffix);

}  // namespace pellucid
