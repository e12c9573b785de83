#pragma once

#include <cstdint>
#include <filesystem>

#include "algorithms/scene/images/image.hpp"

/// One reader for each file format; read_image() chooses by the first bytes. Each throws InputError.
namespace pellucid {

ImageFile read_exr(const std::filesystem::path&);
ImageFile read_png(const std::filesystem::path&, std::uint64_t file_bytes);

}  // namespace pellucid
