#pragma once

#include <filesystem>

#include "algorithms/scene/images/image.hpp"

/// Height, normal and colour maps from files: EXR, PNG of 8 or 16 bits, TGA and JPEG. Rows from the bottom.
namespace pellucid {

/// The file's channels as they are: EXR's own values, the others' over their largest. InputError: missing, damaged, too
/// large.
ImageFile load_map(const std::filesystem::path&);

enum class MapChannel { red, green, blue, alpha };
/// One channel of a map; a grey one serves as red. InputError if the map lacks it, or has a value outside [0, 1].
Image height_map(const ImageFile&, MapChannel);
/// Unit normals, v up; `flip_green` where the file's green points down. InputError if it is no normal map in tangent
/// space.
Image normal_map(const ImageFile&, bool flip_green);
/// Scene-linear colours in [0, 1].
Image color_map(const ImageFile&);

}  // namespace pellucid
