#pragma once

#include "gl/objects.hpp"

namespace pellucid::sandbox {

void delete_renderbuffer(GLuint);

/// A texture as large as the window into which the panel is drawn when it changed: drawing it costs more than a frame
/// of a simple scene where the CPU rasterises.
class PanelLayer {
 public:
  bool fits(int width, int height) const;
  /// Fits the size, clears, and binds for drawing (with a stencil).
  void begin(int width, int height);
  static void end();
  const gl::Texture& texture() const { return texture_; }

 private:
  gl::Texture texture_;
  gl::Framebuffer framebuffer_;
  gl::Handle<delete_renderbuffer> stencil_;
};

}  // namespace pellucid::sandbox
