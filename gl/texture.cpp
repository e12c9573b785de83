#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "gl/context.hpp"
#include "gl/current_context.hpp"
#include "gl/error.hpp"
#include "gl/label.hpp"
#include "gl/objects.hpp"

namespace pellucid::gl {

namespace {

struct FormatTraits {
  Format format;
  GLenum internal, pixel, component;
  int channels;
  std::size_t bytes;
  const char* name;
};

constexpr FormatTraits kFormats[] = {
    {Format::r8, GL_R8, GL_RED, GL_FLOAT, 1, 1, "r8"},
    {Format::rg8, GL_RG8, GL_RG, GL_FLOAT, 2, 2, "rg8"},
    {Format::rgba8, GL_RGBA8, GL_RGBA, GL_FLOAT, 4, 4, "rgba8"},
    {Format::r16f, GL_R16F, GL_RED, GL_FLOAT, 1, 2, "r16f"},
    {Format::rg16f, GL_RG16F, GL_RG, GL_FLOAT, 2, 4, "rg16f"},
    {Format::rgba16f, GL_RGBA16F, GL_RGBA, GL_FLOAT, 4, 8, "rgba16f"},
    {Format::r32f, GL_R32F, GL_RED, GL_FLOAT, 1, 4, "r32f"},
    {Format::rg32f, GL_RG32F, GL_RG, GL_FLOAT, 2, 8, "rg32f"},
    {Format::rgba32f, GL_RGBA32F, GL_RGBA, GL_FLOAT, 4, 16, "rgba32f"},
    {Format::r32ui, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 1, 4, "r32ui"},
    {Format::depth32f, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, 1, 4, "depth32f"},
};

const FormatTraits& traits(Format format) {
  const FormatTraits& entry = kFormats[static_cast<std::size_t>(format)];
  assert(entry.format == format);
  return entry;
}

bool is_flat(GLenum target) {
  return target == GL_TEXTURE_2D;
}

const char* target_name(GLenum target) {
  switch (target) {
    case GL_TEXTURE_2D:
      return "2D";
    case GL_TEXTURE_2D_ARRAY:
      return "2D array";
    case GL_TEXTURE_3D:
      return "3D";
    default:
      return "cube";
  }
}

int level_size(int size, int level) {
  return std::max(1, size >> level);
}

int full_levels(int size) {
  return 1 + static_cast<int>(std::floor(std::log2(size)));
}

struct Shape {
  GLenum target;
  int width, height, depth, levels;
};

struct Size {
  int width = 0, height = 0, depth = 0;
  std::size_t texels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * static_cast<std::size_t>(depth);
  }
};

Size size_of_level(GLenum target, int width, int height, int depth, int level) {
  return {level_size(width, level), level_size(height, level),
          target == GL_TEXTURE_3D ? level_size(depth, level) : depth};
}

// GL pads rows to four bytes, which one channel of halves need not fill.
bool moves_as_halves(Format format) {
  return format == Format::rg16f || format == Format::rgba16f;
}

// Half to single precision (IEEE 754), exact for every value; NaNs keep their payload. Without branches, so that the
// compiler takes several at once.
float single_from_half(std::uint16_t half) {
  const std::uint32_t sign = static_cast<std::uint32_t>(half & 0x8000U) << 16;
  const std::uint32_t rest = static_cast<std::uint32_t>(half & 0x7fffU) << 13;
  // Exponents differ by 127 - 15 = 112; the product makes a subnormal half a normal number.
  const auto finite = std::bit_cast<std::uint32_t>(std::bit_cast<float>(rest) * 0x1p112F);
  const std::uint32_t endless = rest >= 0x1fU << 23 ? 0xffU << 23 : 0U;  // infinities and NaNs
  return std::bit_cast<float>(finite | endless | sign);
}

// GL would report a texture that is too large as GL_INVALID_VALUE; say what is too large, and how much is allowed.
void check_shape(const std::string& label, const Shape& shape) {
  const Limits& limit = limits();
  const auto refuse = [&](const char* what, int value, int most) {
    throw RuntimeError(fmt::format("{} texture '{}' of {}x{}x{} texels: {} {} is outside this device's 1 to {}",
                                   target_name(shape.target), label, shape.width, shape.height, shape.depth, what,
                                   value, most));
  };
  const auto within = [&](const char* what, int value, int most) {
    if (value < 1 || value > most) refuse(what, value, most);
  };
  int side = limit.max_texture_size;
  if (shape.target == GL_TEXTURE_3D) side = limit.max_3d_texture_size;
  if (shape.target == GL_TEXTURE_CUBE_MAP) side = limit.max_cube_size;
  within("width", shape.width, side);
  within("height", shape.height, side);
  if (shape.target == GL_TEXTURE_3D) within("depth", shape.depth, side);
  if (shape.target == GL_TEXTURE_2D_ARRAY) within("number of layers", shape.depth, limit.max_array_layers);
  const int deepest = shape.target == GL_TEXTURE_3D ? shape.depth : 1;
  within("number of mipmap levels", shape.levels, full_levels(std::max({shape.width, shape.height, deepest})));
}

std::size_t storage_bytes(const Shape& shape, Format format) {
  std::size_t bytes = 0;
  for (int level = 0; level < shape.levels; ++level)
    bytes += size_of_level(shape.target, shape.width, shape.height, shape.depth, level).texels() * texel_bytes(format);
  return bytes;
}

GLuint create_texture(const std::string& label, Format format, const Shape& shape) {
  check_shape(label, shape);
  GLuint id = 0;
  glCreateTextures(shape.target, 1, &id);
  Handle<delete_texture> texture(id);
  set_label(GL_TEXTURE, id, label);
  const GLenum internal = traits(format).internal;
  if (is_flat(shape.target) || shape.target == GL_TEXTURE_CUBE_MAP)
    glTextureStorage2D(id, shape.levels, internal, shape.width, shape.height);
  else
    glTextureStorage3D(id, shape.levels, internal, shape.width, shape.height, shape.depth);
  check(fmt::format("allocate {} bytes", storage_bytes(shape, format)), label);
  return texture.release();
}

}  // namespace

int channels(Format format) {
  return traits(format).channels;
}
std::size_t texel_bytes(Format format) {
  return traits(format).bytes;
}
const char* name(Format format) {
  return traits(format).name;
}

void delete_texture(GLuint id) {
  if (detail::has_current()) glDeleteTextures(1, &id);
}

Texture Texture::make_2d(std::string label, Format format, int width, int height, int levels) {
  return {std::move(label), format, GL_TEXTURE_2D, {width, height, 1, levels}};
}

Texture Texture::make_2d_array(std::string label, Format format, int width, int height, int layers, int levels) {
  return {std::move(label), format, GL_TEXTURE_2D_ARRAY, {width, height, layers, levels}};
}

Texture Texture::make_3d(std::string label, Format format, int width, int height, int depth, int levels) {
  return {std::move(label), format, GL_TEXTURE_3D, {width, height, depth, levels}};
}

Texture Texture::make_cube(std::string label, Format format, int size, int levels) {
  return {std::move(label), format, GL_TEXTURE_CUBE_MAP, {size, size, 6, levels}};
}

Texture::Texture(std::string label, Format format, GLenum target, const std::array<int, 4>& size)
    : target_(target),
      format_(format),
      width_(size[0]),
      height_(size[1]),
      depth_(size[2]),
      levels_(size[3]),
      label_(std::move(label)) {
  const Shape shape{target_, width_, height_, depth_, levels_};
  handle_ = Handle<delete_texture>(create_texture(label_, format_, shape));
  bytes_ = storage_bytes(shape, format_);
  account_bytes(static_cast<std::ptrdiff_t>(bytes_));
  set_sampling(Filter::nearest, Wrap::clamp);
}

Texture::~Texture() {
  account_bytes(-static_cast<std::ptrdiff_t>(bytes_));
}

Texture::Texture(Texture&& other) noexcept {
  *this = std::move(other);
}

Texture& Texture::operator=(Texture&& other) noexcept {
  if (this == &other) return *this;
  account_bytes(-static_cast<std::ptrdiff_t>(bytes_));
  handle_ = std::move(other.handle_);
  target_ = std::exchange(other.target_, 0);
  format_ = std::exchange(other.format_, Format::rgba8);
  width_ = std::exchange(other.width_, 0);
  height_ = std::exchange(other.height_, 0);
  depth_ = std::exchange(other.depth_, 0);
  levels_ = std::exchange(other.levels_, 0);
  bytes_ = std::exchange(other.bytes_, 0);
  label_ = std::exchange(other.label_, {});
  return *this;
}

void Texture::upload_level(int level, GLenum component, const void* texels, std::size_t values) {
  assert(id() != 0 && level >= 0 && level < levels_);
  const Size size = size_of_level(target_, width_, height_, depth_, level);
  assert(values == size.texels() * static_cast<std::size_t>(channels(format_)) && "texels do not fill the level");
  const GLenum pixel = traits(format_).pixel;
  if (is_flat(target_))
    glTextureSubImage2D(id(), level, 0, 0, size.width, size.height, pixel, component, texels);
  else
    glTextureSubImage3D(id(), level, 0, 0, 0, size.width, size.height, size.depth, pixel, component, texels);
  check("upload", label_);
}

void Texture::upload(std::span<const float> texels, int level) {
  upload_level(level, traits(format_).component, texels.data(), texels.size());
}

void Texture::upload_halves(std::span<const std::uint16_t> texels, int level) {
  assert(moves_as_halves(format_));
  upload_level(level, GL_HALF_FLOAT, texels.data(), texels.size());
}

void Texture::upload_layer(int layer, std::span<const float> texels, int level) {
  assert(id() != 0 && !is_flat(target_) && level >= 0 && level < levels_);
  const Size size = size_of_level(target_, width_, height_, depth_, level);
  assert(layer >= 0 && layer < size.depth);
  assert(texels.size() * static_cast<std::size_t>(size.depth) ==
             size.texels() * static_cast<std::size_t>(channels(format_)) &&
         "texels do not fill the layer");
  const FormatTraits& t = traits(format_);
  glTextureSubImage3D(id(), level, 0, 0, layer, size.width, size.height, 1, t.pixel, t.component, texels.data());
  check("upload layer", label_);
}

std::vector<float> Texture::read(int level) const {
  assert(id() != 0 && level >= 0 && level < levels_);
  const Size size = size_of_level(target_, width_, height_, depth_, level);
  const FormatTraits& t = traits(format_);
  const std::size_t row = static_cast<std::size_t>(size.width) * static_cast<std::size_t>(t.channels);
  std::vector<float> texels(size.texels() * static_cast<std::size_t>(t.channels));
  // GL takes the size of the destination as an int, so that large textures are read in several rounds.
  const std::size_t most_rows = static_cast<std::size_t>(std::numeric_limits<GLsizei>::max()) / (row * sizeof(float));
  const int rows = static_cast<int>(std::min(static_cast<std::size_t>(size.height), most_rows));
  const int layers = std::max(1, static_cast<int>(std::min(static_cast<std::size_t>(size.depth),
                                                           most_rows / static_cast<std::size_t>(size.height))));
  // Drivers convert slowly: halves are fetched as they are.
  const bool half = moves_as_halves(format_);
  std::vector<std::uint16_t> halves;
  std::size_t at = 0;
  for (int z = 0; z < size.depth; z += layers) {
    const int nz = std::min(layers, size.depth - z);
    for (int y = 0; y < size.height; y += rows) {
      const int ny = std::min(rows, size.height - y);
      const std::size_t count = row * static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz);
      if (half) halves.resize(count);
      void* out = half ? static_cast<void*>(halves.data()) : texels.data() + at;
      glGetTextureSubImage(id(), level, 0, y, z, size.width, ny, nz, t.pixel, half ? GL_HALF_FLOAT : t.component,
                           static_cast<GLsizei>(count * (half ? sizeof(std::uint16_t) : sizeof(float))), out);
      std::transform(halves.begin(), halves.end(), texels.begin() + static_cast<std::ptrdiff_t>(at), single_from_half);
      at += count;
    }
  }
  check("read", label_);
  return texels;
}

void Texture::generate_mipmaps() {
  assert(id() != 0);
  glGenerateTextureMipmap(id());
  check("generate mipmaps", label_);
}

void Texture::set_sampling(Filter filter, Wrap wrap) {
  assert(id() != 0);
  const bool smooth = filter != Filter::nearest && format_ != Format::r32ui;  // integers cannot be interpolated
  GLint minify = smooth ? GL_LINEAR : GL_NEAREST;
  if (filter == Filter::mipmap && smooth) minify = GL_LINEAR_MIPMAP_LINEAR;
  glTextureParameteri(id(), GL_TEXTURE_MIN_FILTER, minify);
  glTextureParameteri(id(), GL_TEXTURE_MAG_FILTER, smooth ? GL_LINEAR : GL_NEAREST);
  GLint mode = GL_CLAMP_TO_EDGE;
  if (wrap == Wrap::repeat) mode = GL_REPEAT;
  if (wrap == Wrap::border) mode = GL_CLAMP_TO_BORDER;
  for (const GLenum axis : std::array<GLenum, 3>{GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTextureParameteri(id(), axis, mode);
  check("set sampling", label_);
}

void Texture::bind(GLuint unit) const {
  assert(id() != 0);
  glBindTextureUnit(unit, id());
  check("bind", label_);
}

void Texture::bind_image(GLuint unit, GLenum access, int level) const {
  assert(id() != 0 && level >= 0 && level < levels_);
  glBindImageTexture(unit, id(), level, is_flat(target_) ? GL_FALSE : GL_TRUE, 0, access, traits(format_).internal);
  check("bind as image", label_);
}

void Texture::clear(const std::array<float, 4>& value) const {
  assert(id() != 0);
  const FormatTraits& t = traits(format_);
  for (int level = 0; level < levels_; ++level) {
    if (format_ == Format::r32ui) {
      const auto number = static_cast<GLuint>(value[0]);
      glClearTexImage(id(), level, t.pixel, t.component, &number);
    } else {
      glClearTexImage(id(), level, t.pixel, t.component, value.data());
    }
  }
  check("clear", label_);
}

}  // namespace pellucid::gl
