#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <png.h>

#include "algorithms/scene/files/atomic_file.hpp"
#include "algorithms/scene/images/chromaticities.hpp"
#include "algorithms/scene/images/image_formats.hpp"
#include "gl/error.hpp"

namespace pellucid {

namespace {

// libpng leaves on an error with longjmp, which must not pass over objects with destructors. So each group of libpng
// calls is a function of its own, run by guarded(), that owns nothing; what it needs lives in Session.
struct Session {
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::FILE* file = nullptr;
  AtomicFile* output = nullptr;
  std::string error;

  int width = 0, height = 0, channels = 0, depth = 0;
  std::size_t stored_row_bytes = 0;  ///< before anything is expanded
  std::vector<png_byte> bytes;
  std::vector<png_bytep> rows;
  std::vector<png_text> texts;

  Session() = default;
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
};

void on_error(png_structp png, png_const_charp message) {
  static_cast<Session*>(png_get_error_ptr(png))->error = message;
  png_longjmp(png, 1);
}
void on_warning(png_structp, png_const_charp) {}

/// Runs `step` and returns whether it came to its end.
bool guarded(Session& s, void (*step)(Session&)) {
  if (setjmp(png_jmpbuf(s.png)) != 0) return false;
  step(s);
  return true;
}

// ---- reading ----

struct ReadSession : Session {
  ReadSession() {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning);
    if (png == nullptr || (info = png_create_info_struct(png)) == nullptr) throw std::bad_alloc();
  }
  ~ReadSession() {
    png_destroy_read_struct(&png, &info, nullptr);
    if (file != nullptr) std::fclose(file);
  }
};

void read_header(Session& s) {
  png_init_io(s.png, s.file);
  png_set_crc_action(s.png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
  png_set_user_limits(s.png, 0x7fffffff, 0x7fffffff);          // our own limit is checked, and worded, by the caller
  png_set_chunk_malloc_max(s.png, png_alloc_size_t{1} << 26);  // what a packed text or profile may become
  png_read_info(s.png, s.info);
  s.width = static_cast<int>(png_get_image_width(s.png, s.info));
  s.height = static_cast<int>(png_get_image_height(s.png, s.info));
  s.stored_row_bytes = png_get_rowbytes(s.png, s.info);
}

/// Asks for gray, RGB or RGBA of 8 or 16 bits in the machine's byte order.
void choose_layout(Session& s) {
  png_set_expand(s.png);  // palette to RGB, 1-4 bits to 8, tRNS to alpha
  if ((png_get_color_type(s.png, s.info) == PNG_COLOR_TYPE_GRAY_ALPHA) ||
      (png_get_color_type(s.png, s.info) == PNG_COLOR_TYPE_GRAY && png_get_valid(s.png, s.info, PNG_INFO_tRNS) != 0)) {
    png_set_gray_to_rgb(s.png);
  }
  if (png_get_bit_depth(s.png, s.info) == 16) png_set_swap(s.png);
  png_set_interlace_handling(s.png);
  png_read_update_info(s.png, s.info);
  s.channels = png_get_channels(s.png, s.info);
  s.depth = png_get_bit_depth(s.png, s.info);
}

void read_rows(Session& s) {
  png_read_image(s.png, s.rows.data());
  png_read_end(s.png, s.info);
}

void read_texts(Session& s, Attributes& attributes) {
  png_textp texts = nullptr;
  const int count = png_get_text(s.png, s.info, &texts, nullptr);
  for (int i = 0; i < count; ++i) {
    attributes.emplace(texts[i].key, texts[i].text != nullptr ? texts[i].text : "");
  }
}

/// W3C PNG (third edition), 11.3.2: an sRGB or iCCP chunk goes before gAMA and cHRM.
PngColor read_color(Session& s) {
  PngColor color;
  int intent = 0;
  color.srgb = png_get_sRGB(s.png, s.info, &intent) != 0;
  png_charp name = nullptr;
  png_bytep profile = nullptr;
  png_uint_32 length = 0;
  int compression = 0;
  if (png_get_iCCP(s.png, s.info, &name, &compression, &profile, &length) != 0) color.icc_profile = name;
  if (color.srgb || !color.icc_profile.empty()) return color;
  double gamma = 0;
  if (png_get_gAMA(s.png, s.info, &gamma) != 0 && gamma > 0) color.gamma = gamma;
  double xy[8] = {};
  if (png_get_cHRM(s.png, s.info, &xy[0], &xy[1], &xy[2], &xy[3], &xy[4], &xy[5], &xy[6], &xy[7]) != 0) {
    const Chromaticities named{{xy[2], xy[3]}, {xy[4], xy[5]}, {xy[6], xy[7]}, {xy[0], xy[1]}};
    color.other_primaries = !named.same_as(Chromaticities{});
  }
  return color;
}

// ---- writing ----

struct WriteSession : Session {
  explicit WriteSession(AtomicFile& target) {
    output = &target;
    png = png_create_write_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning);
    if (png == nullptr || (info = png_create_info_struct(png)) == nullptr) throw std::bad_alloc();
    png_set_write_fn(png, this, write_bytes, [](png_structp) {});
  }
  ~WriteSession() { png_destroy_write_struct(&png, &info); }

 private:
  static void write_bytes(png_structp png, png_bytep bytes, std::size_t count) {
    auto& self = *static_cast<Session*>(png_get_io_ptr(png));
    if (!append(self, bytes, count)) png_longjmp(png, 1);
  }
  static bool append(Session& s, png_bytep bytes, std::size_t count) {
    try {
      s.output->write(std::as_bytes(std::span(bytes, count)));
      return true;
    } catch (const RuntimeError& e) {
      s.error = e.what();
      return false;
    }
  }
};

void write_all(Session& s) {
  const int type = s.channels == 1 ? PNG_COLOR_TYPE_GRAY : s.channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGBA;
  png_set_IHDR(s.png, s.info, static_cast<png_uint_32>(s.width), static_cast<png_uint_32>(s.height), 8, type,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (!s.texts.empty()) png_set_text(s.png, s.info, s.texts.data(), static_cast<int>(s.texts.size()));
  png_write_info(s.png, s.info);
  png_write_image(s.png, s.rows.data());
  png_write_end(s.png, s.info);
}

void set_rows(Session& s, std::size_t row_bytes) {
  s.rows.resize(static_cast<std::size_t>(s.height));
  for (std::size_t y = 0; y < s.rows.size(); ++y)
    s.rows[y] = s.bytes.data() + y * row_bytes;
}

png_byte to_byte(float v) {
  if (!(v > 0.0F)) return 0;  // NaN too
  return static_cast<png_byte>(std::lround(std::min(v, 1.0F) * 255.0F));
}

/// Every chunk must end within the file: libpng takes memory for one before it reads it.
void check_chunk_lengths(const std::filesystem::path& path, std::uint64_t file_bytes) {
  constexpr std::uint64_t kSignature = 8, kAround = 12;  // length, type and check sum
  std::ifstream file(path, std::ios::binary);
  std::array<unsigned char, 8> head{};
  for (std::uint64_t at = kSignature;;) {
    if (at + kAround > file_bytes) throw malformed_image(path, "the PNG file is truncated or damaged");
    file.seekg(static_cast<std::streamoff>(at));
    file.read(reinterpret_cast<char*>(head.data()), head.size());
    std::uint64_t length = 0;  // big-endian
    for (std::size_t i = 0; i < 4; ++i)
      length = length << 8U | head[i];
    if (!file || length > file_bytes - at - kAround)
      throw malformed_image(path, "the PNG file is truncated or damaged");
    if (std::memcmp(head.data() + 4, "IEND", 4) == 0) return;
    at += kAround + length;
  }
}

}  // namespace

PictureFile read_png(const std::filesystem::path& path, std::uint64_t file_bytes) {
  check_chunk_lengths(path, file_bytes);
  ReadSession s;
  s.file = std::fopen(path.c_str(), "rb");
  if (s.file == nullptr) throw malformed_image(path, std::strerror(errno));
  const auto require = [&](bool done) {
    if (!done) throw malformed_image(path, fmt::format("the PNG file is truncated or damaged ({})", s.error));
  };
  require(guarded(s, read_header));
  check_image_size(s.width, s.height, fmt::format("cannot read image '{}'", path.string()));
  require(guarded(s, choose_layout));
  const std::size_t row_bytes = static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.channels * s.depth / 8);
  const std::size_t total = row_bytes * static_cast<std::size_t>(s.height);
  // Deflate shrinks at most 1032-fold.
  if (s.stored_row_bytes * static_cast<std::size_t>(s.height) / 1032U > file_bytes)
    throw malformed_image(path, "the PNG file is truncated");
  PixelMemory(path, file_bytes).take(s.width, s.height, static_cast<std::size_t>(s.channels));
  s.bytes.resize(total);
  set_rows(s, row_bytes);
  require(guarded(s, read_rows));

  PictureFile result;
  result.display_encoded = true;
  result.image = Image(s.width, s.height, s.channels);
  std::vector<float>& pixels = result.image.pixels;
  if (s.depth == 16) {
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      std::uint16_t v = 0;
      std::memcpy(&v, s.bytes.data() + 2 * i, sizeof v);
      pixels[i] = static_cast<float>(v) / 65535.0F;
    }
  } else {
    std::transform(s.bytes.begin(), s.bytes.end(), pixels.begin(),
                   [](png_byte b) { return static_cast<float>(b) / 255.0F; });
  }
  read_texts(s, result.attributes);
  result.data_window = result.display_window = {0, 0, s.width - 1, s.height - 1};
  result.png = read_color(s);
  return result;
}

void write_png(const std::filesystem::path& path, const Image& image, const Attributes& attributes) {
  check_image_size(image.width, image.height, fmt::format("cannot write '{}'", path.string()));
  if (image.channels != 1 && image.channels != 3 && image.channels != 4) {
    throw InputError(
        fmt::format("cannot write '{}': PNG holds 1, 3 or 4 channels, not {}", path.string(), image.channels));
  }
  AtomicFile output(path);
  WriteSession s(output);
  s.width = image.width;
  s.height = image.height;
  s.channels = image.channels;
  s.bytes.resize(image.pixels.size());
  std::transform(image.pixels.begin(), image.pixels.end(), s.bytes.begin(), to_byte);
  set_rows(s, static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.channels));
  for (const auto& [key, text] : attributes) {
    png_text entry{};
    entry.compression = PNG_ITXT_COMPRESSION_NONE;  // UTF-8
    entry.key = const_cast<char*>(key.c_str());
    entry.text = const_cast<char*>(text.c_str());
    s.texts.push_back(entry);
  }
  if (!guarded(s, write_all)) {
    if (s.error.starts_with("cannot write")) throw RuntimeError(s.error);
    throw RuntimeError(fmt::format("cannot write '{}': {}", path.string(), s.error));
  }
  output.commit();
}

}  // namespace pellucid
