#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

#include "algorithms/scene/images/picture_file.hpp"
#include "gl/error.hpp"

/// One reader for each file format; read_image() chooses by the first bytes. Each throws InputError.
namespace pellucid {

PictureFile read_exr(const std::filesystem::path&, const LayerFilter& wanted);
PictureFile read_png(const std::filesystem::path&, std::uint64_t file_bytes);

/// "cannot read image 'path': reason", the reason's first line without its full stop.
InputError malformed_image(const std::filesystem::path&, std::string_view reason);

/// An EXR header's claims, checked before anything of that size is allocated: windows within bounds, and every
/// chunk of each flat part within the file.
void check_exr(const std::filesystem::path&);

}  // namespace pellucid
