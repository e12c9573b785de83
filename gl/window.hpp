#pragma once

#include <memory>
#include <optional>
#include <string>

#include "gl/error.hpp"

struct GLFWwindow;

namespace pellucid::gl {

struct WindowOptions {
  std::string title;
  int width = 1280;  ///< in screen coordinates
  int height = 800;
};

/// There is no display, or none that gives a window with OpenGL.
struct NoDisplay : RuntimeError {
  using RuntimeError::RuntimeError;
};

/// A window with an OpenGL 4.5 core context through EGL, current on construction; the only user of GLFW. Its callbacks
/// are the caller's to set, over `handle()`. Throws NoDisplay with the reason.
class Window {
 public:
  explicit Window(const WindowOptions&);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  GLFWwindow* handle() const { return window_; }
  void show();
  void set_title(const std::string&);
  void swap_buffers();
  /// True when the device was reset and the driver tells: nothing is drawn any more, and only another window helps.
  static bool context_lost();
  bool should_close() const;
  /// Sleeps until there is an event, at most `seconds` when given, and runs the callbacks.
  static void wait_events(std::optional<double> seconds);
  /// Wakes wait_events() from any thread; does nothing while there is no window.
  static void wake();
  /// The monitor's scale: 1 at 96 dots per inch, fractions too.
  float content_scale() const;

 private:
  GLFWwindow* window_ = nullptr;
};

}  // namespace pellucid::gl
