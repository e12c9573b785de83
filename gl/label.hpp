#pragma once

#include <algorithm>
#include <cstddef>
#include <string>

#include <epoxy/gl.h>

namespace pellucid::gl {

/// Names a GL object in debuggers and in the driver's messages. 255 characters fit every implementation.
inline void set_label(GLenum kind, GLuint id, const std::string& label) {
  glObjectLabel(kind, id, static_cast<GLsizei>(std::min<std::size_t>(label.size(), 255)), label.c_str());
}

}  // namespace pellucid::gl
