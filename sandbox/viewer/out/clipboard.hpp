#pragma once

#include <filesystem>
#include <string>

namespace pellucid::sandbox {

/// Puts the contents of a file on the clipboard as `type` ("image/png"), by the program xclip: GLFW's clipboard knows
/// text alone. Throws RuntimeError with the reason, and when xclip is not installed.
void copy_file_to_clipboard(const std::filesystem::path& file, const std::string& type);

}  // namespace pellucid::sandbox
