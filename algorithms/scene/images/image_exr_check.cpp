#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>

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

void check_exr(const std::filesystem::path& path) {
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
