#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace pellucid {

/// A scene-linear (EXR) or display-encoded (PNG) image: rows from the top, channels interleaved, float32.
struct Image {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<float> pixels;

  Image() = default;
  Image(int w, int h, int c)
      : width(w),
        height(h),
        channels(c),
        pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * static_cast<std::size_t>(c)) {}
  std::size_t index(int x, int y) const {
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
           static_cast<std::size_t>(channels);
  }
  float* at(int x, int y) { return pixels.data() + index(x, y); }
  const float* at(int x, int y) const { return pixels.data() + index(x, y); }
};

/// String attributes of a file, by name. Pellucid's own start with "pellucid.".
using Attributes = std::map<std::string, std::string>;

struct ImageFile {
  Image image;  ///< RGB or RGBA of the first part; a luminance-only file gives one channel
  Attributes attributes;
  std::map<std::string, Image> layers;  ///< other named layers ("mask", "depth"), each with its own channels
  bool display_encoded = false;         ///< true for PNG
};

/// Largest image that is read or written, in pixels; a header asking for more is refused before allocating.
inline constexpr std::size_t kMaxImagePixels = std::size_t{1} << 28;

/// Reads EXR or 8/16-bit PNG by the file's first bytes. Throws InputError: missing, truncated, malformed, too large.
ImageFile read_image(const std::filesystem::path&);

enum class ExrPixel { half, single };
/// Writes RGB(A) and the layers ("name.R"), ZIP-compressed, to a temporary file beside `path`, then renames it, so that
/// a failed write never leaves a damaged file. Throws RuntimeError with the reason (unwritable folder, full disk).
void write_exr(const std::filesystem::path&, const ImageFile&, ExrPixel = ExrPixel::half);
/// Clamps display-encoded RGB(A) to [0, 1] and writes 8 bits per channel; attributes become text chunks. Same promise.
void write_png(const std::filesystem::path&, const Image&, const Attributes& = {});

/// Throws InputError when width or height is not in [1, 16384] or their product exceeds kMaxImagePixels.
void check_image_size(long long width, long long height, const std::string& what);

}  // namespace pellucid
