#include "gl/window.hpp"

#include <algorithm>
#include <cstdlib>
#include <mutex>

#include <epoxy/gl.h>
#include <fmt/format.h>

#include "gl/context.hpp"
#include "gl/current_context.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace pellucid::gl {

namespace {

// Threads may wake a window that is just being closed.
std::mutex waking;
bool open_for_waking = false;

std::string glfw_reason() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text != nullptr ? text : "no reason given";
}

}  // namespace

Window::Window(const WindowOptions& options) {
#ifdef GLFW_PLATFORM
  // From version 3.4 on GLFW tries Wayland too, whose library prints an error of its own where nothing says that it is
  // there.
  const char* const wayland = std::getenv("WAYLAND_DISPLAY");
  if (wayland == nullptr || *wayland == '\0') glfwInitHint(GLFW_PLATFORM, GLFW_PLATFORM_X11);
#endif
  if (glfwInit() == GLFW_FALSE) throw NoDisplay(fmt::format("there is no display: {}", glfw_reason()));
  glfwWindowHint(GLFW_CONTEXT_CREATION_API, GLFW_EGL_CONTEXT_API);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, GLFW_TRUE);
  glfwWindowHint(GLFW_STENCIL_BITS, 8);  // NanoVG fills with it
  glfwWindowHint(GLFW_DEPTH_BITS, 0);
  glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
  // A context that tells when the device was reset, where the driver has such.
  glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);
  window_ = glfwCreateWindow(options.width, options.height, options.title.c_str(), nullptr, nullptr);
  if (window_ == nullptr) {
    glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_NO_ROBUSTNESS);
    window_ = glfwCreateWindow(options.width, options.height, options.title.c_str(), nullptr, nullptr);
  }
  if (window_ == nullptr) {
    const std::string reason = glfw_reason();
    glfwTerminate();
    throw NoDisplay(fmt::format("the display gives no window with OpenGL 4.5: {}", reason));
  }
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  adopt_current_context();
  const std::scoped_lock lock(waking);
  open_for_waking = true;
}

Window::~Window() {
  {
    const std::scoped_lock lock(waking);
    open_for_waking = false;
  }
  detail::clear_current();
  glfwDestroyWindow(window_);
  glfwTerminate();
}

void Window::show() {
  glfwShowWindow(window_);
}

void Window::set_title(const std::string& title) {
  glfwSetWindowTitle(window_, title.c_str());
}

void Window::swap_buffers() {
  glfwSwapBuffers(window_);
}

bool Window::context_lost() {
  return glGetGraphicsResetStatus() != GL_NO_ERROR;
}

bool Window::should_close() const {
  return glfwWindowShouldClose(window_) == GLFW_TRUE;
}

void Window::wait_events(std::optional<double> seconds) {
  if (!seconds) {
    glfwWaitEvents();
  } else if (*seconds <= 0) {
    glfwPollEvents();
  } else {
    glfwWaitEventsTimeout(*seconds);
  }
}

void Window::wake() {
  const std::scoped_lock lock(waking);
  if (open_for_waking) glfwPostEmptyEvent();
}

float Window::content_scale() const {
  float x = 1, y = 1;
  glfwGetWindowContentScale(window_, &x, &y);
  return std::max({x, y, 0.5F});
}

}  // namespace pellucid::gl
