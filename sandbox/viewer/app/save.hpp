#pragma once

#include <filesystem>
#include <string>

#include "sandbox/arguments.hpp"
#include "sandbox/viewer/live/picture.hpp"

namespace pellucid::sandbox {

/// A frame as `pellucid render` would write it, with the same attributes.
ImageFile file_of(const Picture&);

/// EXR or PNG by the extension; throws InputError or RuntimeError with the reason (folder, full disk).
void save_picture(const Picture&, const std::filesystem::path&, const DisplayOptions&);

/// The part of a picture that lies in columns [x0, x1) and rows [y0, y1), whose file says of what it is a part. It
/// cannot be made again by itself, so its command is "view --crop".
ImageFile crop_of(const Picture&, int x0, int y0, int x1, int y1);

/// FOLDER/STEM_001.EXTENSION, or the first number that is free.
std::filesystem::path free_name(const std::filesystem::path& folder, const std::string& stem,
                                const std::string& extension);

}  // namespace pellucid::sandbox
