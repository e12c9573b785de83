#pragma once

#include <string>
#include <vector>

#include <epoxy/gl.h>

#include "gl/program.hpp"

namespace pellucid::gl {

/// One stage's text with its line table; `type` is GL_VERTEX_SHADER and the like.
struct StageSource {
  GLenum type = 0;
  ExpandedSource source;
};

/// Compiles and links; errors as for Program. For programs whose text is generated, not a resource.
GLuint link_program(const std::string& label, const std::vector<StageSource>& stages);

}  // namespace pellucid::gl
