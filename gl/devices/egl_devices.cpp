#include "gl/devices/egl_devices.hpp"

#include <cstddef>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "gl/devices/device_node.hpp"

namespace pellucid::gl {
namespace {

/// Whether a text of extensions has one.
bool lists(const char* text, std::string_view name) {
  if (text == nullptr) return false;
  return fmt::format(" {} ", text).find(fmt::format(" {} ", name)) != std::string::npos;
}

}  // namespace

bool has_extension(EGLDisplay display, std::string_view name) {
  return lists(eglQueryString(display, EGL_EXTENSIONS), name);
}

std::vector<EGLDeviceEXT> egl_devices() {
  const auto query = load_egl<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  const bool enumerates = has_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") ||
                          has_extension(EGL_NO_DISPLAY, "EGL_EXT_device_base");
  EGLint count = 0;
  if (!enumerates || query == nullptr || query(0, nullptr, &count) == EGL_FALSE || count <= 0) return {};
  std::vector<EGLDeviceEXT> devices(static_cast<std::size_t>(count));
  if (query(count, devices.data(), &count) == EGL_FALSE) return {};
  devices.resize(static_cast<std::size_t>(count));
  return devices;
}

std::string device_node(int index) {
  const std::vector<EGLDeviceEXT> devices = egl_devices();
  const auto query = load_egl<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  if (index < 0 || static_cast<std::size_t>(index) >= devices.size() || query == nullptr) return {};
  EGLDeviceEXT device = devices[static_cast<std::size_t>(index)];
  const char* extensions = query(device, EGL_EXTENSIONS);
  for (const auto& [extension, name] : {std::pair("EGL_EXT_device_drm_render_node", EGL_DRM_RENDER_NODE_FILE_EXT),
                                        std::pair("EGL_EXT_device_drm", EGL_DRM_DEVICE_FILE_EXT)}) {
    if (!lists(extensions, extension)) continue;
    if (const char* node = query(device, name); node != nullptr) return node;
  }
  return {};
}

}  // namespace pellucid::gl
