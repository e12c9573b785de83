#include <cassert>
#include <cstddef>
#include <initializer_list>
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

void delete_buffer(GLuint id) {
  if (detail::has_current()) glDeleteBuffers(1, &id);
}

void delete_vertex_array(GLuint id) {
  if (detail::has_current()) glDeleteVertexArrays(1, &id);
}

Buffer::Buffer(std::string label, std::size_t bytes, GLenum usage) : usage_(usage), label_(std::move(label)) {
  GLuint id = 0;
  glCreateBuffers(1, &id);
  handle_ = Handle<delete_buffer>(id);
  set_label(GL_BUFFER, id, label_);
  allocate(bytes, nullptr);
}

Buffer::~Buffer() {
  account_bytes(-static_cast<std::ptrdiff_t>(bytes_));
}

Buffer::Buffer(Buffer&& other) noexcept {
  *this = std::move(other);
}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
  if (this == &other) return *this;
  account_bytes(-static_cast<std::ptrdiff_t>(bytes_));
  handle_ = std::move(other.handle_);
  bytes_ = std::exchange(other.bytes_, 0);
  usage_ = std::exchange(other.usage_, GL_STATIC_DRAW);
  label_ = std::exchange(other.label_, {});
  return *this;
}

void Buffer::allocate(std::size_t bytes, const void* data) {
  if (bytes > static_cast<std::size_t>(std::numeric_limits<GLsizeiptr>::max()))
    throw RuntimeError(fmt::format("buffer '{}' of {} bytes is larger than OpenGL can address", label_, bytes));
  glNamedBufferData(handle_.id(), static_cast<GLsizeiptr>(bytes), data, usage_);
  check(fmt::format("allocate {} bytes", bytes), label_);
  account_bytes(static_cast<std::ptrdiff_t>(bytes) - static_cast<std::ptrdiff_t>(bytes_));
  bytes_ = bytes;
}

void Buffer::upload(std::span<const std::byte> data) {
  assert(id() != 0);
  // Data that is replaced every frame gets fresh storage, so that the driver need not wait for the last frame.
  const bool replaces_all = data.size() == bytes_ && usage_ != GL_STATIC_DRAW;
  if (data.size() > bytes_ || replaces_all) {
    allocate(data.size(), data.data());
  } else if (!data.empty()) {
    glNamedBufferSubData(id(), 0, static_cast<GLsizeiptr>(data.size()), data.data());
    check("upload", label_);
  }
}

std::vector<std::byte> Buffer::read() const {
  assert(id() != 0);
  std::vector<std::byte> data(bytes_);
  if (bytes_ > 0) glGetNamedBufferSubData(id(), 0, static_cast<GLsizeiptr>(bytes_), data.data());
  check("read", label_);
  return data;
}

void Buffer::bind_uniform(GLuint index) const {
  assert(id() != 0);
  if (bytes_ > limits().max_ubo_bytes)
    throw RuntimeError(fmt::format("buffer '{}' of {} bytes does not fit a uniform block, {} bytes on this device",
                                   label_, bytes_, limits().max_ubo_bytes));
  glBindBufferBase(GL_UNIFORM_BUFFER, index, id());
  check("bind as uniform block", label_);
}

void Buffer::bind_storage(GLuint index) const {
  assert(id() != 0);
  if (bytes_ > limits().max_ssbo_bytes)
    throw RuntimeError(fmt::format("buffer '{}' of {} bytes does not fit a storage block, {} bytes on this device",
                                   label_, bytes_, limits().max_ssbo_bytes));
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, index, id());
  check("bind as storage block", label_);
}

VertexArray::VertexArray(std::string label) : label_(std::move(label)) {
  GLuint id = 0;
  glCreateVertexArrays(1, &id);
  handle_ = Handle<delete_vertex_array>(id);
  set_label(GL_VERTEX_ARRAY, id, label_);
  check("create", label_);
}

VertexArray::VertexArray(std::string label, const Buffer& vertices, std::size_t stride,
                         std::initializer_list<VertexAttribute> attributes, const Buffer* indices)
    : VertexArray(std::move(label)) {
  add_binding(vertices, stride, attributes, 0);
  if (indices != nullptr) glVertexArrayElementBuffer(id(), indices->id());
  check("attach indices", label_);
}

VertexArray::~VertexArray() = default;

VertexArray::VertexArray(VertexArray&& other) noexcept {
  *this = std::move(other);
}

VertexArray& VertexArray::operator=(VertexArray&& other) noexcept {
  if (this == &other) return *this;
  handle_ = std::move(other.handle_);
  bindings_ = std::exchange(other.bindings_, 0);
  label_ = std::exchange(other.label_, {});
  return *this;
}

void VertexArray::add_instanced(const Buffer& buffer, std::size_t stride,
                                std::initializer_list<VertexAttribute> attributes) {
  add_binding(buffer, stride, attributes, 1);
}

void VertexArray::add_binding(const Buffer& buffer, std::size_t stride,
                              std::initializer_list<VertexAttribute> attributes, GLuint divisor) {
  assert(id() != 0);
  const GLuint binding = bindings_++;
  glVertexArrayVertexBuffer(id(), binding, buffer.id(), 0, static_cast<GLsizei>(stride));
  glVertexArrayBindingDivisor(id(), binding, divisor);
  for (const VertexAttribute& attribute : attributes) {
    glEnableVertexArrayAttrib(id(), attribute.location);
    glVertexArrayAttribFormat(id(), attribute.location, attribute.components, GL_FLOAT, GL_FALSE,
                              static_cast<GLuint>(attribute.offset));
    glVertexArrayAttribBinding(id(), attribute.location, binding);
  }
  check("attach vertices", label_);
}

void VertexArray::bind() const {
  assert(id() != 0);
  glBindVertexArray(id());
  check("bind", label_);
}

}  // namespace pellucid::gl
