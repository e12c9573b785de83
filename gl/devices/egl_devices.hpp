#pragma once

#include <string_view>
#include <vector>

#include <EGL/egl.h>
#include <EGL/eglext.h>

namespace pellucid::gl {

/// Whether the display, or EGL itself without one, has the extension.
bool has_extension(EGLDisplay, std::string_view name);

/// An extension's function; null without it.
template <class Function>
Function load_egl(const char* name) {
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

/// In EGL's order, by which `--device` numbers them.
std::vector<EGLDeviceEXT> egl_devices();

}  // namespace pellucid::gl
