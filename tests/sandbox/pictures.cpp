#include "tests/sandbox/pictures.hpp"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace pellucid::test {
namespace {

// EXR files are little-endian, as are the machines that this runs on.
static_assert(std::endian::native == std::endian::little);

template <class T>
std::string bytes_of(const T& value) {
  std::string out(sizeof(T), '\0');
  std::memcpy(out.data(), &value, sizeof(T));
  return out;
}

std::string exr_attribute(const std::string& name, const std::string& type, const std::string& value) {
  return name + '\0' + type + '\0' + bytes_of(static_cast<std::int32_t>(value.size())) + value;
}

std::string big_endian(std::uint32_t value) {
  std::string out;
  for (int shift = 24; shift >= 0; shift -= 8)
    out.push_back(static_cast<char>((value >> shift) & 0xFFU));
  return out;
}

// The checksum of a PNG's chunk (ISO 3309).
std::uint32_t crc32(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit)
      crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

}  // namespace

Image flat(int width, int height, float r, float g, float b) {
  Image image(width, height, 3);
  for (std::size_t i = 0; i < image.pixels.size(); i += 3) {
    image.pixels[i] = r;
    image.pixels[i + 1] = g;
    image.pixels[i + 2] = b;
  }
  return image;
}

Image pattern(int width, int height) {
  Image image(width, height, 3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      float* pixel = image.at(x, y);
      pixel[0] = (static_cast<float>(x) + 0.5F) / static_cast<float>(width);
      pixel[1] = (static_cast<float>(y) + 0.5F) / static_cast<float>(height);
      pixel[2] = (x / 4 + y / 4) % 2 == 0 ? 0.25F : 0.75F;
    }
  }
  return image;
}

std::filesystem::path write_exr_file(const std::filesystem::path& path, const Image& image) {
  ImageFile file;
  file.image = image;
  write_exr(path, file, ExrPixel::single);
  return path;
}

std::filesystem::path write_png_file(const std::filesystem::path& path, const Image& image) {
  write_png(path, image);
  return path;
}

std::string exr_header(int x_min, int y_min, int x_max, int y_max) {
  const std::string window = bytes_of(std::array{x_min, y_min, x_max, y_max});
  std::string channels;
  for (const char* name : {"B", "G", "R"}) {
    // Name, pixel type half, linearity and padding, sampling in x and y.
    channels += std::string(name) + '\0' + bytes_of(std::array<std::int32_t, 4>{1, 0, 1, 1});
  }
  channels.push_back('\0');
  std::string out = bytes_of(std::int32_t{20000630}) + bytes_of(std::int32_t{2});
  out += exr_attribute("channels", "chlist", channels);
  out += exr_attribute("compression", "compression", std::string(1, '\3'));  // ZIP
  out += exr_attribute("dataWindow", "box2i", window);
  out += exr_attribute("displayWindow", "box2i", window);
  out += exr_attribute("lineOrder", "lineOrder", std::string(1, '\0'));
  out += exr_attribute("pixelAspectRatio", "float", bytes_of(1.0F));
  out += exr_attribute("screenWindowCenter", "v2f", bytes_of(std::array{0.0F, 0.0F}));
  out += exr_attribute("screenWindowWidth", "float", bytes_of(1.0F));
  out.push_back('\0');
  return out;
}

std::string png_header(unsigned width, unsigned height) {
  auto chunk = [](const std::string& content) {
    return big_endian(static_cast<std::uint32_t>(content.size() - 4)) + content + big_endian(crc32(content));
  };
  // Pixel data begin, so that a reader believes the size before it meets the end.
  return std::string("\x89PNG\r\n\x1a\n") +
         chunk("IHDR" + big_endian(width) + big_endian(height) + std::string("\x10\x06\0\0\0", 5)) +
         chunk("IDAT" + std::string("\x78\x9c\x63\x60", 4));
}

}  // namespace pellucid::test
