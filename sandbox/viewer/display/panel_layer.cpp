#include "sandbox/viewer/display/panel_layer.hpp"

#include <epoxy/gl.h>

#include "gl/context.hpp"

namespace pellucid::sandbox {

void delete_renderbuffer(GLuint id) {
  glDeleteRenderbuffers(1, &id);
}

bool PanelLayer::fits(int width, int height) const {
  return texture_ && texture_.width() == width && texture_.height() == height;
}

void PanelLayer::begin(int width, int height) {
  if (!fits(width, height)) {
    texture_ = gl::Texture::make_2d("panel", gl::Format::rgba8, width, height);
    framebuffer_ = gl::Framebuffer("panel", {&texture_});
    GLuint id = 0;
    glCreateRenderbuffers(1, &id);
    stencil_ = gl::Handle<delete_renderbuffer>(id);
    glNamedRenderbufferStorage(id, GL_DEPTH24_STENCIL8, width, height);
    glNamedFramebufferRenderbuffer(framebuffer_.id(), GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER, id);
    gl::check("allocate", "panel");
  }
  framebuffer_.bind();
  glDisable(GL_SCISSOR_TEST);
  const GLint zero = 0;
  framebuffer_.clear_color(0, {0, 0, 0, 0});
  glStencilMask(0xff);
  glClearNamedFramebufferiv(framebuffer_.id(), GL_STENCIL, 0, &zero);
}

void PanelLayer::end() {
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  gl::check("draw", "panel");
}

}  // namespace pellucid::sandbox
