#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <list>
#include <string>
#include <string_view>
#include <vector>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include "algorithms/scene/files/atomic_file.hpp"
#include "algorithms/scene/images/exr_slices.hpp"
#include "algorithms/scene/images/picture_file.hpp"
#include "gl/error.hpp"

namespace pellucid {

namespace {

constexpr float kHalfMax = 65504.0F;

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

ExrPixel exact_pixel(const Image& image) {
  const bool half = std::all_of(image.pixels.begin(), image.pixels.end(),
                                [](float v) { return static_cast<float>(Imath::half(v)) == v; });
  return half ? ExrPixel::half : ExrPixel::single;
}

std::size_t saturated_pixels(const Image& image) {
  std::size_t count = 0;
  const int colors = std::min(image.channels, 3);
  for (std::size_t i = 0; i < image.pixels.size(); i += static_cast<std::size_t>(image.channels)) {
    const float* pixel = image.pixels.data() + i;
    count += std::any_of(pixel, pixel + colors, [](float v) { return std::abs(v) >= kHalfMax; }) ? 1 : 0;
  }
  return count;
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
    auto add = [&](const Image& source, const std::string& prefix, ExrPixel wanted) {
      assert(source.width == image.width && source.height == image.height && source.channels >= 1);
      const Group names = channel_names(prefix, source.channels);
      const Imf::PixelType type = pixel_type(source, wanted);
      for (const std::string& channel : names)
        header.channels().insert(channel, Imf::Channel(type));
      if (type == Imf::HALF) {
        const auto& converted = halves.emplace_back(source.pixels.begin(), source.pixels.end());
        add_slices(frame, header.dataWindow(), converted.data(), names);
      } else {
        add_slices(frame, header.dataWindow(), source.pixels.data(), names);
      }
    };
    add(image, "", pixel);
    for (const auto& [layer, pixels] : file.layers)
      add(pixels, layer + ".", ExrPixel::single);
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
