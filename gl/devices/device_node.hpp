#pragma once

#include <string>

namespace pellucid::gl {

/// The device's file, which tells two equal cards apart: its DRM render node, else its DRM node (EGL_EXT_device_drm);
/// empty for a device in software and where the driver does not say.
std::string device_node(int index);

}  // namespace pellucid::gl
