#include <algorithm>
#include <cassert>
#include <cmath>
#include <exception>
#include <list>
#include <memory>
#include <set>
#include <string_view>
#include <type_traits>

#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>
#include <half.h>
#include <openexr.h>

#include "algorithms/scene/files/atomic_file.hpp"
#include "algorithms/scene/images/image_formats.hpp"
#include "gl/error.hpp"

namespace pellucid {

namespace {

constexpr int kMaxChannels = 64;
constexpr float kHalfMax = 65504.0F;

InputError malformed(const std::filesystem::path& path, std::string_view reason) {
  reason = reason.substr(0, reason.find('\n'));
  while (reason.ends_with('.') || reason.ends_with(' '))
    reason.remove_suffix(1);
  return InputError(fmt::format("cannot read image '{}': {}", path.string(), reason));
}

// ---- what the file claims, checked before anything of that size is allocated ----

struct ContextCloser {
  void operator()(_priv_exr_context_t* context) const { exr_finish(&context); }
};
using Context = std::unique_ptr<_priv_exr_context_t, ContextCloser>;

/// Every chunk must lie within the file. A cut file otherwise shows only after its pixels have been allocated.
void check_chunks(const std::filesystem::path& path, exr_const_context_t context, int part,
                  const exr_attr_box2i_t& box) {
  exr_storage_t storage{};
  if (exr_get_storage(context, part, &storage) != EXR_ERR_SUCCESS) throw malformed(path, "malformed OpenEXR header");
  exr_chunk_info_t chunk{};
  auto require = [&](exr_result_t result) {
    if (result != EXR_ERR_SUCCESS) throw malformed(path, "the OpenEXR file is truncated or damaged");
  };
  if (storage == EXR_STORAGE_SCANLINE) {
    std::int32_t lines = 1;
    require(exr_get_scanlines_per_chunk(context, part, &lines));
    for (long long y = box.min.y; y <= box.max.y; y += std::max(lines, 1)) {
      require(exr_read_scanline_chunk_info(context, part, static_cast<int>(y), &chunk));
    }
  } else if (storage == EXR_STORAGE_TILED) {
    std::int32_t tile_width = 0;
    std::int32_t tile_height = 0;
    require(exr_get_tile_sizes(context, part, 0, 0, &tile_width, &tile_height));
    if (tile_width < 1 || tile_height < 1) throw malformed(path, "malformed OpenEXR header");
    const std::int32_t across = (box.max.x - box.min.x) / tile_width + 1;
    const std::int32_t down = (box.max.y - box.min.y) / tile_height + 1;
    for (std::int32_t y = 0; y < down; ++y) {
      for (std::int32_t x = 0; x < across; ++x)
        require(exr_read_tile_chunk_info(context, part, x, y, 0, 0, &chunk));
    }
  } else {
    throw malformed(path, "deep OpenEXR images are not supported");
  }
}

void check_file(const std::filesystem::path& path) {
  exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
  options.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};  // the C++ reader words it
  exr_context_t opened = nullptr;
  if (const exr_result_t result = exr_start_read(&opened, path.c_str(), &options); result != EXR_ERR_SUCCESS) {
    throw malformed(path, fmt::format("malformed OpenEXR header ({})", exr_get_default_error_message(result)));
  }
  const Context context(opened);
  int parts = 0;
  exr_get_count(context.get(), &parts);
  std::size_t samples = 0;
  for (int part = 0; part < parts; ++part) {
    exr_attr_box2i_t box{};
    const exr_attr_chlist_t* channels = nullptr;
    if (exr_get_data_window(context.get(), part, &box) != EXR_ERR_SUCCESS ||
        exr_get_channels(context.get(), part, &channels) != EXR_ERR_SUCCESS) {
      throw malformed(path, "malformed OpenEXR header");
    }
    const long long width = static_cast<long long>(box.max.x) - box.min.x + 1;
    const long long height = static_cast<long long>(box.max.y) - box.min.y + 1;
    check_image_size(width, height, fmt::format("cannot read image '{}'", path.string()));
    if (channels->num_channels < 1 || channels->num_channels > kMaxChannels) {
      throw malformed(path,
                      fmt::format("{} channels in a part; at most {} are read", channels->num_channels, kMaxChannels));
    }
    samples += static_cast<std::size_t>(width * height) * static_cast<std::size_t>(channels->num_channels);
    if (samples > 4 * kMaxImagePixels) {
      throw malformed(
          path, fmt::format("{} channels of {}x{} pixels are too much to read", channels->num_channels, width, height));
    }
    check_chunks(path, context.get(), part, box);
  }
}

// ---- channels and layers ----

/// R, G, B, A first, then the rest by name.
int channel_rank(std::string_view channel) {
  const auto at = std::string_view("RGBA").find(channel);
  return channel.size() == 1 && at != std::string_view::npos ? static_cast<int>(at) : 4;
}

using Group = std::vector<std::string>;  // full channel names, in the order of the image's channels

struct PartGroups {
  Group main;
  std::map<std::string, Group> layers;
};

PartGroups group_channels(const Imf::ChannelList& channels, const std::filesystem::path& path) {
  PartGroups groups;
  std::set<std::string> plain;
  for (auto it = channels.begin(); it != channels.end(); ++it) {
    const std::string channel = it.name();
    if (it.channel().xSampling != 1 || it.channel().ySampling != 1) {
      throw malformed(path, fmt::format("channel '{}' is subsampled, which is not supported", channel));
    }
    const auto dot = channel.rfind('.');
    if (dot == std::string::npos)
      plain.insert(channel);
    else
      groups.layers[channel.substr(0, dot)].push_back(channel);
  }
  if (plain.contains("R") && plain.contains("G") && plain.contains("B")) {
    groups.main = {"R", "G", "B"};
    if (plain.contains("A")) groups.main.emplace_back("A");
  } else if (plain.contains("Y")) {
    groups.main = {"Y"};
  }
  for (const std::string& channel : groups.main)
    plain.erase(channel);
  for (const std::string& channel : plain)
    groups.layers[channel].push_back(channel);
  for (auto& [layer, group] : groups.layers) {
    auto tail = [](const std::string& c) { return std::string_view(c).substr(c.rfind('.') + 1); };
    std::stable_sort(group.begin(), group.end(), [&](const std::string& a, const std::string& b) {
      return std::pair(channel_rank(tail(a)), tail(a)) < std::pair(channel_rank(tail(b)), tail(b));
    });
  }
  return groups;
}

/// Interleaved slices over `pixels`, whose first one lies at the data window's corner.
template <class Pixel>
void add_slices(Imf::FrameBuffer& frame, const Imath::Box2i& window, const Pixel* pixels, const Group& group) {
  constexpr Imf::PixelType kType = std::is_same_v<Pixel, Imath::half> ? Imf::HALF : Imf::FLOAT;
  const std::size_t x_stride = sizeof(Pixel) * group.size();
  const std::size_t y_stride = x_stride * static_cast<std::size_t>(window.max.x - window.min.x + 1);
  for (std::size_t c = 0; c < group.size(); ++c) {
    frame.insert(group[c], Imf::Slice::Make(kType, pixels + c, window, x_stride, y_stride));
  }
}

std::string part_name(const Imf::Header& header, int part) {
  return header.hasName() && !header.name().empty() ? header.name() : fmt::format("part{}", part);
}

void read_attributes(const Imf::Header& header, Attributes& attributes) {
  for (auto it = header.begin(); it != header.end(); ++it) {
    const std::string_view key = it.name();
    if (key == "name" || key == "type" || key == "view") continue;  // the format's own
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&it.attribute())) {
      attributes.emplace(key, text->value());
    }
  }
}

void read_part(const std::filesystem::path& path, Imf::MultiPartInputFile& file, int number, ImageFile& result) {
  const Imf::Header& header = file.header(number);
  const Imath::Box2i window = header.dataWindow();
  const int width = window.max.x - window.min.x + 1;
  const int height = window.max.y - window.min.y + 1;
  PartGroups groups = group_channels(header.channels(), path);
  read_attributes(header, result.attributes);
  Imf::FrameBuffer frame;
  auto attach = [&](Image& image, const Group& group) {
    image = Image(width, height, static_cast<int>(group.size()));
    add_slices(frame, window, image.pixels.data(), group);
  };
  if (number == 0 && groups.main.empty()) {
    std::vector<std::string> names;
    for (auto it = header.channels().begin(); it != header.channels().end(); ++it)
      names.emplace_back(it.name());
    throw malformed(path, fmt::format("no channels R, G, B or Y; it has {}", fmt::join(names, ", ")));
  }
  if (number == 0)
    attach(result.image, groups.main);
  else if (!groups.main.empty())
    groups.layers.emplace(part_name(header, number), groups.main);
  for (const auto& [layer, group] : groups.layers) {
    const bool taken = result.layers.contains(layer);
    attach(result.layers[taken ? part_name(header, number) + "." + layer : layer], group);
  }
  Imf::InputPart part(file, number);
  part.setFrameBuffer(frame);
  part.readPixels(window.min.y, window.max.y);
}

// ---- writing ----

class AtomicStream : public Imf::OStream {
 public:
  explicit AtomicStream(AtomicFile& file, const std::string& shown) : OStream(shown.c_str()), file_(file) {}
  void write(const char bytes[], int count) override {
    guarded([&] { file_.write(std::string_view(bytes, static_cast<std::size_t>(count))); });
  }
  std::uint64_t tellp() override {
    std::uint64_t at = 0;
    guarded([&] { at = file_.position(); });
    return at;
  }
  void seekp(std::uint64_t to) override {
    guarded([&] { file_.seek(to); });
  }
  /// The first error; OpenEXR rewords what passes through it, and drops it in destructors.
  std::exception_ptr error;

 private:
  template <class F>
  void guarded(F&& f) {
    try {
      f();
    } catch (...) {
      if (!error) error = std::current_exception();
      throw;
    }
  }
  AtomicFile& file_;
};

Group channel_names(const std::string& prefix, int channels) {
  static constexpr std::string_view kColor[] = {"R", "G", "B", "A"};
  Group names;
  for (int c = 0; c < channels; ++c) {
    std::string name = channels == 1 ? "Y" : channels <= 4 ? std::string(kColor[c]) : fmt::format("C{:02}", c);
    names.push_back(prefix + name);
  }
  return names;
}

/// Half cannot hold a finite value above 65504; such a layer is stored in 32 bits rather than turned into infinities.
Imf::PixelType pixel_type(const Image& image, ExrPixel wanted) {
  if (wanted == ExrPixel::single) return Imf::FLOAT;
  const bool fits = std::none_of(image.pixels.begin(), image.pixels.end(),
                                 [](float v) { return std::isfinite(v) && std::abs(v) > kHalfMax; });
  return fits ? Imf::HALF : Imf::FLOAT;
}

}  // namespace

ImageFile read_exr(const std::filesystem::path& path) {
  check_file(path);
  ImageFile result;
  try {
    Imf::MultiPartInputFile file(path.c_str());
    for (int part = 0; part < file.parts(); ++part)
      read_part(path, file, part, result);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& e) {
    throw malformed(path, fmt::format("the OpenEXR file is truncated or damaged: {}", e.what()));
  }
  return result;
}

void write_exr(const std::filesystem::path& path, const ImageFile& file, ExrPixel pixel) {
  const Image& image = file.image;
  check_image_size(image.width, image.height, fmt::format("cannot write '{}'", path.string()));
  AtomicFile output(path);
  AtomicStream stream(output, path.string());
  try {
    Imf::Header header(image.width, image.height, 1.0F, Imath::V2f(0, 0), 1.0F, Imf::INCREASING_Y,
                       Imf::ZIP_COMPRESSION);
    for (const auto& [key, text] : file.attributes)
      header.insert(key, Imf::StringAttribute(text));
    Imf::FrameBuffer frame;
    std::list<std::vector<Imath::half>> halves;  // OpenEXR converts when reading, but not when writing
    auto add = [&](const Image& source, const std::string& prefix) {
      assert(source.width == image.width && source.height == image.height && source.channels >= 1);
      const Group names = channel_names(prefix, source.channels);
      const Imf::PixelType type = pixel_type(source, pixel);
      for (const std::string& channel : names)
        header.channels().insert(channel, Imf::Channel(type));
      if (type == Imf::HALF) {
        const auto& converted = halves.emplace_back(source.pixels.begin(), source.pixels.end());
        add_slices(frame, header.dataWindow(), converted.data(), names);
      } else {
        add_slices(frame, header.dataWindow(), source.pixels.data(), names);
      }
    };
    add(image, "");
    for (const auto& [layer, pixels] : file.layers)
      add(pixels, layer + ".");
    {
      Imf::OutputFile exr(stream, header);
      exr.setFrameBuffer(frame);
      exr.writePixels(image.height);
    }
    if (stream.error) std::rethrow_exception(stream.error);
    output.commit();
  } catch (const RuntimeError&) {
    throw;
  } catch (const std::exception& e) {
    if (stream.error) std::rethrow_exception(stream.error);
    throw RuntimeError(fmt::format("cannot write '{}': {}", path.string(), e.what()));
  }
}

}  // namespace pellucid
