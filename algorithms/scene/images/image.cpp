#include "algorithms/scene/images/image.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
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

bool every_layer(const std::string&) {
  return true;
}
bool no_layer(const std::string&) {
  return false;
}

std::string size_text(const PictureFile& file) {
  const std::string size = fmt::format("{}x{} pixels", file.image.width, file.image.height);
  if (file.data_window == file.display_window) return size;
  const auto corners = [](const PixelWindow& w) {
    return fmt::format("({}, {})-({}, {})", w.min_x, w.min_y, w.max_x, w.max_y);
  };
  return fmt::format("{} (display window {}, data window {})", size, corners(file.display_window),
                     corners(file.data_window));
}

InputError malformed_image(const std::filesystem::path& path, std::string_view reason) {
  reason = reason.substr(0, reason.find('\n'));
  while (reason.ends_with('.') || reason.ends_with(' '))
    reason.remove_suffix(1);
  return InputError(fmt::format("cannot read image '{}': {}", path.string(), reason));
}

PixelMemory::PixelMemory(const std::filesystem::path& path, std::uint64_t file_bytes)
    : path_(path), file_bytes_(file_bytes) {
  constexpr std::uint64_t kAlways = std::uint64_t{384} << 20;  // 8K UHD in RGB, all of it black
  most_ = std::min(std::max(kAlways, 4128 * file_bytes), 4 * sizeof(float) * std::uint64_t{kMaxImagePixels});
}

void PixelMemory::take(int width, int height, std::size_t channels) {
  taken_ += static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) * channels * sizeof(float);
  if (taken_ <= most_) return;
  constexpr std::uint64_t kMebi = 1 << 20;
  throw malformed_image(
      path_,
      fmt::format("{} channels of {}x{} pixels are too much to read: {} MiB with what was read before; a file of {} "
                  "bytes may take {} MiB",
                  channels, width, height, taken_ / kMebi, file_bytes_, most_ / kMebi));
}

PictureFile read_picture(const std::filesystem::path& path, const LayerFilter& wanted) {
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
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (start.starts_with(kExrMagic)) return read_exr(path, error ? 0 : bytes, wanted);
  if (start == kPngMagic) return read_png(path, error ? 0 : bytes);
  throw InputError(fmt::format("cannot read image '{}': neither OpenEXR nor PNG", shown));
}

ImageFile read_image(const std::filesystem::path& path) {
  return read_picture(path);
}

}  // namespace pellucid
