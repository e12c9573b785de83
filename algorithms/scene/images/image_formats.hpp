#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>

#include "algorithms/scene/images/picture_file.hpp"
#include "gl/error.hpp"

/// One reader for each file format; read_image() chooses by the first bytes. Each throws InputError.
namespace pellucid {

PictureFile read_exr(const std::filesystem::path&, std::uint64_t file_bytes, const LayerFilter& wanted);
PictureFile read_png(const std::filesystem::path&, std::uint64_t file_bytes);
/// Adds up the memory that a file's pixels take, before it is taken. Some compressions pack a black picture of any size
/// into a few hundred bytes, and only a limit tells such a file from a small one of great claims.
class PixelMemory {
 public:
  PixelMemory(const std::filesystem::path&, std::uint64_t file_bytes);
  /// Throws when all pixels so far take more than 384 MiB and more than 4128 times the file's bytes: deflate shrinks
  /// at most 1032-fold (zlib.net/zlib_tech.html), and 8 bits become 32.
  void take(int width, int height, std::size_t channels);

 private:
  const std::filesystem::path& path_;
  std::uint64_t most_ = 0, taken_ = 0, file_bytes_ = 0;
};

/// "cannot read image 'path': reason", the reason's first line without its full stop.
InputError malformed_image(const std::filesystem::path&, std::string_view reason);

/// An EXR header's claims, checked before anything of that size is allocated: windows within bounds, and every
/// attribute and every chunk of each flat part within the file.
void check_exr(const std::filesystem::path&, std::uint64_t file_bytes);

}  // namespace pellucid
