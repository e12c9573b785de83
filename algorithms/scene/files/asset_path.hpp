#pragma once

#include <filesystem>
#include <string_view>

namespace pellucid {

/// The file that a scene's text means: "asset:NAME" lies under $PELLUCID_ASSETS, or without it under `assets` of the
/// source tree; everything else is relative to `folder`. Throws InputError when it does not exist, for an asset with
/// the command that gets it.
std::filesystem::path resolve_asset(std::string_view reference, const std::filesystem::path& folder);

}  // namespace pellucid
