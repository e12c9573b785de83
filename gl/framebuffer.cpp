#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <initializer_list>
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

GLuint create_framebuffer(const std::string& label) {
  GLuint id = 0;
  glCreateFramebuffers(1, &id);
  set_label(GL_FRAMEBUFFER, id, label);
  return id;
}

const char* status_text(GLenum status) {
  switch (status) {
    case GL_FRAMEBUFFER_INCOMPLETE_ATTACHMENT:
      return "an attachment cannot be drawn into";
    case GL_FRAMEBUFFER_INCOMPLETE_MISSING_ATTACHMENT:
      return "nothing is attached";
    case GL_FRAMEBUFFER_INCOMPLETE_LAYER_TARGETS:
      return "some attachments are layered and others are not";
    case GL_FRAMEBUFFER_UNSUPPORTED:
      return "the device does not draw into these formats together";
    default:
      return "it is incomplete";
  }
}

GLenum color_attachment(std::size_t i) {
  return GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(i);
}

}  // namespace

void delete_framebuffer(GLuint id) {
  if (detail::has_current()) glDeleteFramebuffers(1, &id);
}

Framebuffer::Framebuffer(std::string label, std::initializer_list<const Texture*> colors, const Texture* depth)
    : label_(std::move(label)) {
  handle_ = Handle<delete_framebuffer>(create_framebuffer(label_));
  const std::span<const Texture* const> attached(colors.begin(), colors.size());
  const Texture* first = attached.empty() ? depth : attached.front();
  assert(first != nullptr && "a framebuffer needs an attachment");
  width_ = first->width();
  height_ = first->height();
  const auto same_size = [&](const Texture& texture) {
    if (texture.width() != width_ || texture.height() != height_)
      throw RuntimeError(fmt::format("framebuffer '{}': '{}' is {}x{}, but '{}' is {}x{}", label_, first->label(),
                                     width_, height_, texture.label(), texture.width(), texture.height()));
  };
  for (std::size_t i = 0; i < attached.size(); ++i) {
    same_size(*attached[i]);
    glNamedFramebufferTexture(id(), color_attachment(i), attached[i]->id(), 0);
  }
  if (depth != nullptr) {
    same_size(*depth);
    glNamedFramebufferTexture(id(), GL_DEPTH_ATTACHMENT, depth->id(), 0);
  }
  finish(attached);
}

Framebuffer Framebuffer::layered(std::string label, std::initializer_list<const Texture*> colors, const Texture* depth,
                                 int layer, int level) {
  const std::span<const Texture* const> attached(colors.begin(), colors.size());
  assert(!attached.empty() && level >= 0);
  Framebuffer result;
  result.label_ = std::move(label);
  result.handle_ = Handle<delete_framebuffer>(create_framebuffer(result.label_));
  const Texture& first = *attached.front();
  result.width_ = std::max(1, first.width() >> level);
  result.height_ = std::max(1, first.height() >> level);
  const auto attach = [&](GLenum point, const Texture& texture, int at_level) {
    assert(at_level < texture.levels());
    const int width = std::max(1, texture.width() >> at_level), height = std::max(1, texture.height() >> at_level);
    if (width != result.width_ || height != result.height_)
      throw RuntimeError(fmt::format("framebuffer '{}': '{}' is {}x{} at level {}, but '{}' is {}x{}", result.label_,
                                     first.label(), result.width_, result.height_, level, texture.label(), width,
                                     height));
    if (layer < 0 || texture.target() == GL_TEXTURE_2D)
      glNamedFramebufferTexture(result.id(), point, texture.id(), at_level);
    else
      glNamedFramebufferTextureLayer(result.id(), point, texture.id(), at_level, layer);
  };
  for (std::size_t i = 0; i < attached.size(); ++i)
    attach(color_attachment(i), *attached[i], level);
  // A depth buffer with mipmaps follows the colours' level; one without was made for this level.
  if (depth != nullptr) attach(GL_DEPTH_ATTACHMENT, *depth, depth->levels() > 1 ? level : 0);
  result.finish(attached);
  return result;
}

Framebuffer::~Framebuffer() = default;

Framebuffer::Framebuffer(Framebuffer&& other) noexcept {
  *this = std::move(other);
}

Framebuffer& Framebuffer::operator=(Framebuffer&& other) noexcept {
  if (this == &other) return *this;
  handle_ = std::move(other.handle_);
  width_ = std::exchange(other.width_, 0);
  height_ = std::exchange(other.height_, 0);
  integer_attachments_ = std::exchange(other.integer_attachments_, 0);
  label_ = std::exchange(other.label_, {});
  return *this;
}

void Framebuffer::finish(std::span<const Texture* const> colors) {
  std::vector<GLenum> targets;
  for (std::size_t i = 0; i < colors.size(); ++i) {
    targets.push_back(color_attachment(i));
    if (colors[i]->format() == Format::r32ui) integer_attachments_ |= 1U << i;
  }
  if (targets.empty()) {
    glNamedFramebufferDrawBuffer(id(), GL_NONE);
    glNamedFramebufferReadBuffer(id(), GL_NONE);
  } else {
    glNamedFramebufferDrawBuffers(id(), static_cast<GLsizei>(targets.size()), targets.data());
  }
  check("attach", label_);
  if (const GLenum status = glCheckNamedFramebufferStatus(id(), GL_FRAMEBUFFER); status != GL_FRAMEBUFFER_COMPLETE)
    throw RuntimeError(fmt::format("framebuffer '{}': {} ({:#x})", label_, status_text(status), status));
}

void Framebuffer::bind() const {
  assert(id() != 0);
  glBindFramebuffer(GL_FRAMEBUFFER, id());
  glViewport(0, 0, width_, height_);
  check("bind", label_);
}

void Framebuffer::clear_color(int attachment, const std::array<float, 4>& value) const {
  assert(id() != 0 && attachment >= 0);
  if ((integer_attachments_ >> static_cast<unsigned>(attachment) & 1U) != 0) {
    const std::array<GLuint, 4> numbers = {static_cast<GLuint>(value[0]), static_cast<GLuint>(value[1]),
                                           static_cast<GLuint>(value[2]), static_cast<GLuint>(value[3])};
    glClearNamedFramebufferuiv(id(), GL_COLOR, attachment, numbers.data());
  } else {
    glClearNamedFramebufferfv(id(), GL_COLOR, attachment, value.data());
  }
  check("clear colour", label_);
}

void Framebuffer::clear_depth(float value) const {
  assert(id() != 0);
  glClearNamedFramebufferfv(id(), GL_DEPTH, 0, &value);
  check("clear depth", label_);
}

}  // namespace pellucid::gl
