#pragma once

#include <string>

#include "gl/context.hpp"

/// The state of this thread's GL context as far as it is known. Private to gl/: context.cpp sets it, the wrappers read
/// it.
namespace pellucid::gl::detail {

/// Marks the GL context that EGL (or the window system) has just made current, with what was read from it.
void set_current(const Limits& limits, bool debug, bool software);
void clear_current();

/// False after the context is gone: names of its objects must then not be given to GL.
bool has_current();

/// GL_VENDOR, GL_RENDERER and GL_VERSION of whatever is current. (Here because epoxy and EGL/egl.h exclude each other.)
Device describe_current();

/// True if `renderer` (GL_RENDERER) names a CPU rasteriser.
bool is_software(const std::string& renderer);

/// True if an error waits for `check`; it lets callers build a longer description only when one is needed.
bool has_errors();

/// Forgets errors that were reported another way, such as a shader's info log.
void drop_errors();

}  // namespace pellucid::gl::detail
