#pragma once

#include "algorithms/scene/scene.hpp"
#include "gl/program.hpp"

namespace pellucid {

/// The surface that algorithms/shaders/mirror.glsl reflects by: a mirror or a metal.
void set_mirror(const gl::Program&, const Material&);

}  // namespace pellucid
