#pragma once

#include <filesystem>
#include <string>

#include "algorithms/scene/images/image.hpp"

/// Image files to hand to the program, sound and broken.
namespace pellucid::test {

/// An RGB image of one colour.
Image flat(int width, int height, float r, float g, float b);
/// An RGB image with some structure, values in (0, 1).
Image pattern(int width, int height);

std::filesystem::path write_exr_file(const std::filesystem::path&, const Image&);  ///< 32-bit channels
std::filesystem::path write_png_file(const std::filesystem::path&, const Image&);

/// The bytes of an EXR's header that declares a data window of those corners, and of nothing after it.
std::string exr_header(int x_min, int y_min, int x_max, int y_max);
/// The bytes of a PNG that declares that size, 16-bit RGBA, and of the first few of its pixel data.
std::string png_header(unsigned width, unsigned height);

}  // namespace pellucid::test
