#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <openexr.h>

#include "algorithms/scene/images/image_formats.hpp"

namespace pellucid {
namespace {

constexpr int kMaxChannels = 1024;

struct ContextCloser {
  void operator()(_priv_exr_context_t* context) const { exr_finish(&context); }
};
using Context = std::unique_ptr<_priv_exr_context_t, ContextCloser>;

// ---- attributes: "OpenEXR File Layout", openexr.com ----

std::int32_t number_at(std::string_view bytes, std::size_t at) {
  std::int32_t value = 0;  // little-endian, as the machine
  if (at + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// The C++ library reads these types by their own size, whatever the header says.
constexpr std::array<std::pair<std::string_view, std::size_t>, 24> kFixedSizes{{{"box2i", 16},
                                                                                {"box2f", 16},
                                                                                {"chromaticities", 32},
                                                                                {"compression", 1},
                                                                                {"deepImageState", 1},
                                                                                {"double", 8},
                                                                                {"envmap", 1},
                                                                                {"float", 4},
                                                                                {"int", 4},
                                                                                {"keycode", 28},
                                                                                {"lineOrder", 1},
                                                                                {"m33f", 36},
                                                                                {"m33d", 72},
                                                                                {"m44f", 64},
                                                                                {"m44d", 128},
                                                                                {"rational", 8},
                                                                                {"tiledesc", 9},
                                                                                {"timecode", 8},
                                                                                {"v2i", 8},
                                                                                {"v2f", 8},
                                                                                {"v2d", 16},
                                                                                {"v3i", 12},
                                                                                {"v3f", 12},
                                                                                {"v3d", 24}}};

/// Whether the value is as long as its type says, and what it counts lies within it.
bool is_whole(std::string_view type, std::string_view value) {
  for (const auto& [fixed, size] : kFixedSizes)
    if (type == fixed) return value.size() == size;
  if (type == "preview") {
    const std::int64_t width = number_at(value, 0), height = number_at(value, 4);
    return value.size() >= 8 && width >= 0 && height >= 0 &&
           width * height == static_cast<std::int64_t>((value.size() - 8) / 4) && value.size() % 4 == 0;
  }
  std::size_t at = 0;
  if (type == "stringvector") {
    while (at + 4 <= value.size() && number_at(value, at) >= 0)
      at += 4 + static_cast<std::size_t>(number_at(value, at));
    return at == value.size();
  }
  if (type == "chlist") {
    while (at < value.size() && value[at] != '\0') {
      const auto end = value.find('\0', at);
      if (end == std::string_view::npos) return false;
      at = end + 1 + 16;  // pixel type, linearity, sampling
    }
    return at + 1 == value.size();
  }
  return true;
}

/// Every attribute must be whole and end within the file. The C++ library takes memory for one before it reads it.
void check_attributes(const std::filesystem::path& path, std::uint64_t file_bytes) {
  constexpr std::uint32_t kManyParts = 0x1000;
  std::ifstream file(path, std::ios::binary);
  std::string head(8, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  const bool many = (static_cast<std::uint32_t>(number_at(head, 4)) & kManyParts) != 0;
  for (bool any = true; any;) {
    any = false;
    for (std::string name, type, value; std::getline(file, name, '\0') && !name.empty(); any = many) {
      std::getline(file, type, '\0');
      std::array<char, 4> count{};
      file.read(count.data(), count.size());
      const std::int32_t size = number_at({count.data(), count.size()}, 0);
      const bool fits = file && size >= 0 &&
                        static_cast<std::uint64_t>(size) <= file_bytes - static_cast<std::uint64_t>(file.tellg());
      if (fits) {
        value.resize(static_cast<std::size_t>(size));
        file.read(value.data(), size);
      }
      if (!fits || !is_whole(type, value)) throw malformed_image(path, "the OpenEXR file is truncated or damaged");
    }
  }
}

// ---- chunks ----

/// Every chunk must lie within the file. A cut file otherwise shows only after its pixels have been allocated.
void check_chunks(const std::filesystem::path& path, exr_const_context_t context, int part, exr_storage_t storage,
                  const exr_attr_box2i_t& box) {
  exr_chunk_info_t chunk{};
  auto require = [&](exr_result_t result) {
    if (result != EXR_ERR_SUCCESS) throw malformed_image(path, "the OpenEXR file is truncated or damaged");
  };
  if (storage == EXR_STORAGE_SCANLINE) {
    std::int32_t lines = 1;
    require(exr_get_scanlines_per_chunk(context, part, &lines));
    for (long long y = box.min.y; y <= box.max.y; y += std::max(lines, 1)) {
      require(exr_read_scanline_chunk_info(context, part, static_cast<int>(y), &chunk));
    }
    return;
  }
  std::int32_t tile_width = 0;
  std::int32_t tile_height = 0;
  require(exr_get_tile_sizes(context, part, 0, 0, &tile_width, &tile_height));
  if (tile_width < 1 || tile_height < 1) throw malformed_image(path, "malformed OpenEXR header");
  const std::int32_t across = (box.max.x - box.min.x) / tile_width + 1;
  const std::int32_t down = (box.max.y - box.min.y) / tile_height + 1;
  for (std::int32_t y = 0; y < down; ++y) {
    for (std::int32_t x = 0; x < across; ++x)
      require(exr_read_tile_chunk_info(context, part, x, y, 0, 0, &chunk));
  }
}

void check_window(const std::filesystem::path& path, const exr_attr_box2i_t& box) {
  check_image_size(static_cast<long long>(box.max.x) - box.min.x + 1, static_cast<long long>(box.max.y) - box.min.y + 1,
                   fmt::format("cannot read image '{}'", path.string()));
}

}  // namespace

void check_exr(const std::filesystem::path& path, std::uint64_t file_bytes) {
  check_attributes(path, file_bytes);
  exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
  options.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};  // the C++ reader words it
  exr_context_t opened = nullptr;
  const exr_result_t result = exr_start_read(&opened, path.c_str(), &options);
  // This library asks a flat part beside a deep one for a version that the C++ library neither writes nor misses.
  if (result == EXR_ERR_MISSING_REQ_ATTR) return;
  if (result != EXR_ERR_SUCCESS) {
    throw malformed_image(path, fmt::format("malformed OpenEXR header ({})", exr_get_default_error_message(result)));
  }
  const Context context(opened);
  int parts = 0;
  exr_get_count(context.get(), &parts);
  for (int part = 0; part < parts; ++part) {
    exr_storage_t storage{};
    if (exr_get_storage(context.get(), part, &storage) != EXR_ERR_SUCCESS)
      throw malformed_image(path, "malformed OpenEXR header");
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED) continue;  // deep: not read
    exr_attr_box2i_t data{}, display{};
    const exr_attr_chlist_t* channels = nullptr;
    if (exr_get_data_window(context.get(), part, &data) != EXR_ERR_SUCCESS ||
        exr_get_display_window(context.get(), part, &display) != EXR_ERR_SUCCESS ||
        exr_get_channels(context.get(), part, &channels) != EXR_ERR_SUCCESS) {
      throw malformed_image(path, "malformed OpenEXR header");
    }
    check_window(path, data);
    check_window(path, display);
    if (channels->num_channels < 1 || channels->num_channels > kMaxChannels) {
      throw malformed_image(
          path, fmt::format("{} channels in a part; at most {} are read", channels->num_channels, kMaxChannels));
    }
    check_chunks(path, context.get(), part, storage, data);
  }
}

}  // namespace pellucid
