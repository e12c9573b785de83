#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <epoxy/gl.h>

/// OpenGL objects as move-only values over direct state access. A moved-from object is the empty one (`id() == 0`).
/// Every object carries a label, shown in debuggers and in every error. A GL context must be current.
namespace pellucid::gl {

/// Owns one GL name; `Delete` frees it.
template <void (*Delete)(GLuint)>
class Handle {
 public:
  Handle() = default;
  explicit Handle(GLuint id) : id_(id) {}
  ~Handle() { reset(); }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      reset();
      id_ = std::exchange(other.id_, 0);
    }
    return *this;
  }
  GLuint id() const { return id_; }
  GLuint release() { return std::exchange(id_, 0); }
  void reset() {
    if (id_ != 0) Delete(std::exchange(id_, 0));
  }

 private:
  GLuint id_ = 0;
};

enum class Format { r8, rg8, rgba8, r16f, rg16f, rgba16f, r32f, rg32f, rgba32f, r32ui, depth32f };

int channels(Format);
std::size_t texel_bytes(Format);
const char* name(Format);

enum class Filter { nearest, linear, mipmap };
enum class Wrap { clamp, repeat, border };  ///< border is transparent black

void delete_texture(GLuint);
void delete_framebuffer(GLuint);
void delete_buffer(GLuint);
void delete_vertex_array(GLuint);

/// A texture with immutable storage. Sizes in texels; throws RuntimeError naming the label, the size and the device's
/// limit before allocating when it is too large. `upload` takes tightly packed rows, bottom row first (GL's order), as
/// float for every format but r32ui, whose texels are the bits of a uint32 (std::bit_cast); `read` returns the same. A
/// new texture holds undefined texels and samples nearest, clamped, over all its levels.
class Texture {
 public:
  Texture() = default;
  static Texture make_2d(std::string label, Format, int width, int height, int levels = 1);
  static Texture make_2d_array(std::string label, Format, int width, int height, int layers, int levels = 1);
  static Texture make_3d(std::string label, Format, int width, int height, int depth, int levels = 1);
  static Texture make_cube(std::string label, Format, int size, int levels = 1);

  void upload(std::span<const float> texels, int level = 0);
  /// As `upload`, texels in half precision already; of rg16f and rgba16f alone.
  void upload_halves(std::span<const std::uint16_t> texels, int level = 0);
  void upload_layer(int layer, std::span<const float> texels, int level = 0);  ///< array layer or cube face
  std::vector<float> read(int level = 0) const;
  void generate_mipmaps();
  void set_sampling(Filter, Wrap);
  void bind(GLuint unit) const;
  void bind_image(GLuint unit, GLenum access, int level = 0) const;
  void clear(const std::array<float, 4>& value) const;

  GLuint id() const { return handle_.id(); }
  GLenum target() const { return target_; }
  Format format() const { return format_; }
  int width() const { return width_; }
  int height() const { return height_; }
  int depth() const { return depth_; }  ///< layers of an array, 6 for a cube
  int levels() const { return levels_; }
  const std::string& label() const { return label_; }
  std::size_t bytes() const { return bytes_; }
  explicit operator bool() const { return id() != 0; }

  ~Texture();
  Texture(Texture&&) noexcept;
  Texture& operator=(Texture&&) noexcept;

 private:
  Texture(std::string label, Format, GLenum target, const std::array<int, 4>& width_height_depth_levels);
  void upload_level(int level, GLenum component, const void* texels, std::size_t values);
  Handle<delete_texture> handle_;
  GLenum target_ = 0;
  Format format_ = Format::rgba8;
  int width_ = 0, height_ = 0, depth_ = 0, levels_ = 0;
  std::size_t bytes_ = 0;
  std::string label_;
};

/// Colour attachments and an optional depth attachment; it does not own the textures, which must outlive it.
class Framebuffer {
 public:
  Framebuffer() = default;
  Framebuffer(std::string label, std::initializer_list<const Texture*> colors, const Texture* depth = nullptr);
  /// One layer (or cube face) of each colour; with layer < 0 all layers, for layered rendering.
  static Framebuffer layered(std::string label, std::initializer_list<const Texture*> colors, const Texture* depth,
                             int layer, int level = 0);
  static Framebuffer layered(std::string label, const Texture& color, const Texture* depth, int layer, int level = 0) {
    return layered(std::move(label), {&color}, depth, layer, level);
  }

  void bind() const;  ///< also sets the viewport to the attachments' size
  void clear_color(int attachment, const std::array<float, 4>& value) const;
  void clear_depth(float value = 1.0F) const;
  GLuint id() const { return handle_.id(); }
  int width() const { return width_; }
  int height() const { return height_; }

  ~Framebuffer();
  Framebuffer(Framebuffer&&) noexcept;
  Framebuffer& operator=(Framebuffer&&) noexcept;

 private:
  void finish(std::span<const Texture* const> colors);
  Handle<delete_framebuffer> handle_;
  int width_ = 0, height_ = 0;
  unsigned integer_attachments_ = 0;  // bit i: attachment i holds unsigned integers
  std::string label_;
};

/// A buffer; `usage` is GL_STATIC_DRAW for data uploaded once and GL_STREAM_DRAW for data replaced every frame.
class Buffer {
 public:
  Buffer() = default;
  Buffer(std::string label, std::size_t bytes, GLenum usage = GL_STATIC_DRAW);
  template <class T>
  Buffer(std::string label, std::span<const T> data, GLenum usage = GL_STATIC_DRAW)
      : Buffer(std::move(label), data.size_bytes(), usage) {
    upload(std::as_bytes(data));
  }
  /// Replaces the first `data.size()` bytes; grows the storage when they do not fit.
  void upload(std::span<const std::byte> data);
  template <class T>
  void upload(std::span<const T> data) {
    upload(std::as_bytes(data));
  }
  std::vector<std::byte> read() const;
  void bind_uniform(GLuint index) const;
  void bind_storage(GLuint index) const;
  GLuint id() const { return handle_.id(); }
  std::size_t bytes() const { return bytes_; }

  ~Buffer();
  Buffer(Buffer&&) noexcept;
  Buffer& operator=(Buffer&&) noexcept;

 private:
  void allocate(std::size_t bytes, const void* data);
  Handle<delete_buffer> handle_;
  std::size_t bytes_ = 0;
  GLenum usage_ = GL_STATIC_DRAW;
  std::string label_;
};

struct VertexAttribute {
  GLuint location = 0;
  int components = 3;  ///< floats
  std::size_t offset = 0;
};

/// Vertex layout over one interleaved vertex buffer and an optional index buffer of uint32.
class VertexArray {
 public:
  VertexArray() = default;
  VertexArray(std::string label, const Buffer& vertices, std::size_t stride,
              std::initializer_list<VertexAttribute> attributes, const Buffer* indices = nullptr);
  explicit VertexArray(std::string label);  ///< no attributes: a full-screen triangle from gl_VertexID
  /// A second buffer that advances once per instance.
  void add_instanced(const Buffer& buffer, std::size_t stride, std::initializer_list<VertexAttribute> attributes);
  void bind() const;
  GLuint id() const { return handle_.id(); }

  ~VertexArray();
  VertexArray(VertexArray&&) noexcept;
  VertexArray& operator=(VertexArray&&) noexcept;

 private:
  void add_binding(const Buffer& buffer, std::size_t stride, std::initializer_list<VertexAttribute> attributes,
                   GLuint divisor);
  Handle<delete_vertex_array> handle_;
  GLuint bindings_ = 0;
  std::string label_;
};

}  // namespace pellucid::gl
