#include "algorithms/scene/images/image.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>

#include <fmt/format.h>

#include "algorithms/scene/images/image_formats.hpp"
#include "gl/error.hpp"

namespace pellucid {

namespace {

constexpr long long kMaxSide = 16384;
constexpr std::string_view kExrMagic("\x76\x2f\x31\x01", 4);
constexpr std::string_view kPngMagic("\x89PNG\r\n\x1a\n", 8);

}  // namespace

void check_image_size(long long width, long long height, const std::string& what) {
  const bool sides = width >= 1 && height >= 1 && width <= kMaxSide && height <= kMaxSide;
  if (sides && static_cast<std::size_t>(width) * static_cast<std::size_t>(height) <= kMaxImagePixels) return;
  throw InputError(fmt::format("{}: {}x{} pixels is out of range; width and height must be in [1, {}]", what, width,
                               height, kMaxSide));
}

ImageFile read_image(const std::filesystem::path& path) {
  const std::string shown = path.string();
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (error) throw InputError(fmt::format("cannot read image '{}': {}", shown, error.message()));
  if (!std::filesystem::is_regular_file(status)) {
    throw InputError(fmt::format("cannot read image '{}': {}", shown,
                                 std::filesystem::exists(status) ? "not a regular file" : std::strerror(ENOENT)));
  }
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("cannot read image '{}': {}", shown, std::strerror(errno)));
  std::array<char, 8> head{};
  file.read(head.data(), head.size());
  const std::string_view start(head.data(), static_cast<std::size_t>(file.gcount()));
  file.close();
  if (start.empty()) throw InputError(fmt::format("cannot read image '{}': the file is empty", shown));
  if (start.starts_with(kExrMagic)) return read_exr(path);
  if (start == kPngMagic) {
    const std::uintmax_t bytes = std::filesystem::file_size(path, error);
    return read_png(path, error ? 0 : bytes);
  }
  throw InputError(fmt::format("cannot read image '{}': neither OpenEXR nor PNG", shown));
}

}  // namespace pellucid
