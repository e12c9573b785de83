#include "gl/context.hpp"

#include <array>
#include <cassert>
#include <map>
#include <mutex>
#include <tuple>
#include <utility>

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/format.h>

#include "gl/current_context.hpp"
#include "gl/devices/egl_devices.hpp"
#include "gl/error.hpp"

namespace pellucid::gl {

namespace {

constexpr int kSurfaceless = -1;

std::string egl_error() {
  switch (const EGLint error = eglGetError()) {
    case EGL_SUCCESS:
      return "no reason given";
    case EGL_NOT_INITIALIZED:
      return "EGL_NOT_INITIALIZED";
    case EGL_BAD_ACCESS:
      return "EGL_BAD_ACCESS";
    case EGL_BAD_ALLOC:
      return "EGL_BAD_ALLOC";
    case EGL_BAD_ATTRIBUTE:
      return "EGL_BAD_ATTRIBUTE";
    case EGL_BAD_CONFIG:
      return "EGL_BAD_CONFIG";
    case EGL_BAD_CONTEXT:
      return "EGL_BAD_CONTEXT";
    case EGL_BAD_DISPLAY:
      return "EGL_BAD_DISPLAY";
    case EGL_BAD_MATCH:
      return "EGL_BAD_MATCH";
    case EGL_BAD_PARAMETER:
      return "EGL_BAD_PARAMETER";
    default:
      return fmt::format("EGL error {:#x}", error);
  }
}

// EGL hands out one display per device, and eglTerminate ends it for everybody: count who uses it.
class DisplayUsers {
 public:
  void acquire(EGLDisplay display) {
    const std::scoped_lock lock(mutex_);
    EGLint major = 0, minor = 0;
    if (eglInitialize(display, &major, &minor) == EGL_FALSE)
      throw RuntimeError(fmt::format("EGL does not initialise: {}", egl_error()));
    ++users_[display];
  }
  void release(EGLDisplay display) noexcept {
    const std::scoped_lock lock(mutex_);
    if (const auto it = users_.find(display); it != users_.end() && --it->second == 0) {
      users_.erase(it);
      // LeakSanitizer can name, and so suppress, what a driver leaks only while the driver stays loaded.
#ifndef PELLUCID_SANITIZE
      eglTerminate(display);
#endif
    }
  }

 private:
  std::mutex mutex_;
  std::map<EGLDisplay, int> users_;
};

DisplayUsers& display_users() {
  static auto* users = new DisplayUsers;  // outlives every static Context
  return *users;
}

struct Opened {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
};

EGLDisplay platform_display(EGLenum platform, void* native) {
  const auto get = load_egl<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  const EGLDisplay display = get != nullptr ? get(platform, native, nullptr) : EGL_NO_DISPLAY;
  if (display == EGL_NO_DISPLAY) throw RuntimeError(fmt::format("EGL gives no display: {}", egl_error()));
  return display;
}

EGLConfig choose_config(EGLDisplay display) {
  if (has_extension(display, "EGL_KHR_no_config_context")) return EGL_NO_CONFIG_KHR;
  const std::array<EGLint, 5> wanted = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                        EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (eglChooseConfig(display, wanted.data(), &config, 1, &count) == EGL_FALSE || count == 0)
    throw RuntimeError("EGL offers no configuration for OpenGL");
  return config;
}

// A context on `display`, made current. Leaves nothing behind when it throws.
Opened open_context(EGLDisplay display, bool debug) {
  display_users().acquire(display);
  EGLContext context = EGL_NO_CONTEXT;
  try {
    if (!has_extension(display, "EGL_KHR_surfaceless_context"))
      throw RuntimeError("EGL_KHR_surfaceless_context is missing");
    if (eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) throw RuntimeError("EGL does not offer desktop OpenGL");
    const std::array<EGLint, 9> attributes = {EGL_CONTEXT_MAJOR_VERSION,
                                              4,
                                              EGL_CONTEXT_MINOR_VERSION,
                                              5,
                                              EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                              EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                              EGL_CONTEXT_OPENGL_DEBUG,
                                              debug ? EGL_TRUE : EGL_FALSE,
                                              EGL_NONE};
    context = eglCreateContext(display, choose_config(display), EGL_NO_CONTEXT, attributes.data());
    if (context == EGL_NO_CONTEXT) throw RuntimeError(fmt::format("no OpenGL 4.5 core context: {}", egl_error()));
    if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_FALSE)
      throw RuntimeError(fmt::format("the context cannot be made current: {}", egl_error()));
  } catch (...) {
    if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
    display_users().release(display);
    throw;
  }
  return {display, context};
}

Opened open_device(EGLDeviceEXT device, bool debug) {
  return open_context(platform_display(EGL_PLATFORM_DEVICE_EXT, device), debug);
}

Opened open_surfaceless(bool debug) {
  if (!has_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
    throw RuntimeError("EGL_MESA_platform_surfaceless is missing");
  return open_context(platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY), debug);
}

void close_context(const Opened& opened) noexcept {
  eglDestroyContext(opened.display, opened.context);
  display_users().release(opened.display);
}

Device describe(int index) {
  Device device = detail::describe_current();
  device.index = index;
  device.platform = index == kSurfaceless ? "surfaceless" : "device";
  return device;
}

Opened open_chosen(int index, bool debug) {
  if (index == kSurfaceless) return open_surfaceless(debug);
  const std::vector<EGLDeviceEXT> devices = egl_devices();
  if (index < 0 || static_cast<std::size_t>(index) >= devices.size()) {
    std::string known;
    for (const Device& device : list_devices()) {
      if (device.index < 0) continue;  // without a device there is no number to pass
      if (!known.empty()) known += ", ";
      known += fmt::format("{} ({})", device.index, device.renderer);
    }
    throw InputError(fmt::format("--device {}: no such device; there {}", index,
                                 known.empty() ? "is none that gives an OpenGL 4.5 context" : "are " + known));
  }
  try {
    return open_device(devices[static_cast<std::size_t>(index)], debug);
  } catch (const RuntimeError& error) {
    throw RuntimeError(fmt::format("device {} gives no OpenGL 4.5 context: {}", index, error.what()));
  }
}

// The first device that works; the rest are not tried, since each costs tens of milliseconds.
std::pair<Opened, int> open_first(bool debug) {
  std::string reasons;
  const std::vector<EGLDeviceEXT> devices = egl_devices();
  for (std::size_t i = 0; i < devices.size(); ++i) {
    try {
      return {open_device(devices[i], debug), static_cast<int>(i)};
    } catch (const RuntimeError& error) {
      reasons += fmt::format("device {}: {}; ", i, error.what());
    }
  }
  try {
    return {open_surfaceless(debug), kSurfaceless};
  } catch (const RuntimeError& error) {
    throw RuntimeError(fmt::format("no OpenGL 4.5 context: {}surfaceless: {}", reasons, error.what()));
  }
}

// Puts back the EGL context that was current, for probing without side effects.
class RestoreCurrent {
 public:
  RestoreCurrent()
      : api_(eglQueryAPI()),
        display_(eglGetCurrentDisplay()),
        context_(eglGetCurrentContext()),
        draw_(eglGetCurrentSurface(EGL_DRAW)),
        read_(eglGetCurrentSurface(EGL_READ)) {}
  ~RestoreCurrent() { restore(); }
  RestoreCurrent(const RestoreCurrent&) = delete;
  RestoreCurrent& operator=(const RestoreCurrent&) = delete;
  void restore() const {
    const EGLDisplay leaving = eglGetCurrentDisplay();
    eglBindAPI(api_);
    if (context_ != EGL_NO_CONTEXT)
      eglMakeCurrent(display_, draw_, read_, context_);
    else if (leaving != EGL_NO_DISPLAY)
      eglMakeCurrent(leaving, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }

 private:
  EGLenum api_;
  EGLDisplay display_;
  EGLContext context_;
  EGLSurface draw_, read_;
};

}  // namespace

std::vector<Device> list_devices() {
  std::vector<Device> found;
  const RestoreCurrent previous;
  const auto probe = [&](int index, auto&& open) {
    try {
      const Opened opened = open();
      found.push_back(describe(index));
      previous.restore();
      close_context(opened);
    } catch (const RuntimeError&) {  // a device without a context is not one to offer
    }
  };
  const std::vector<EGLDeviceEXT> devices = egl_devices();
  for (std::size_t i = 0; i < devices.size(); ++i)
    probe(static_cast<int>(i), [&] { return open_device(devices[i], false); });
  probe(kSurfaceless, [] { return open_surfaceless(false); });
  return found;
}

Context::Context(const ContextOptions& options) : debug_(options.debug) {
  int index = options.device.value_or(kSurfaceless);
  Opened opened;
  if (options.device.has_value())
    opened = open_chosen(index, debug_);
  else
    std::tie(opened, index) = open_first(debug_);
  display_ = opened.display;
  context_ = opened.context;
  device_ = describe(index);
  limits_ = adopt_current_context(debug_);
}

Context::~Context() {
  release();
}

Context::Context(Context&& other) noexcept
    : display_(std::exchange(other.display_, nullptr)),
      context_(std::exchange(other.context_, nullptr)),
      debug_(std::exchange(other.debug_, false)),
      device_(std::exchange(other.device_, {})),
      limits_(std::exchange(other.limits_, {})) {}

Context& Context::operator=(Context&& other) noexcept {
  if (this != &other) {
    release();
    display_ = std::exchange(other.display_, nullptr);
    context_ = std::exchange(other.context_, nullptr);
    debug_ = std::exchange(other.debug_, false);
    device_ = std::exchange(other.device_, {});
    limits_ = std::exchange(other.limits_, {});
  }
  return *this;
}

void Context::make_current() {
  assert(context_ != nullptr && "an empty context cannot be made current");
  eglBindAPI(EGL_OPENGL_API);
  if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE)
    throw RuntimeError(fmt::format("the context of '{}' cannot be made current: {}", device_.renderer, egl_error()));
  detail::set_current(limits_, debug_, software());
}

bool Context::software() const {
  return detail::is_software(device_.renderer);
}

void Context::release() noexcept {
  if (context_ == nullptr) return;
  if (eglGetCurrentContext() == context_) {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    detail::clear_current();
  }
  close_context({display_, context_});
  display_ = nullptr;
  context_ = nullptr;
}

}  // namespace pellucid::gl
