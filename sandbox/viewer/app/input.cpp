#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "sandbox/viewer/app/app.hpp"
#include "sandbox/viewer/camera/drag_parameter.hpp"
#include "sandbox/viewer/camera/orbit.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace pellucid::sandbox {
namespace {

// The first swap may still be of a buffer of the old size.
constexpr int kRedrawsAfterResize = 2;

App* app_of(GLFWwindow* window) {
  return static_cast<App*>(glfwGetWindowUserPointer(window));
}

bool flies(int key) {
  return key == GLFW_KEY_W || key == GLFW_KEY_A || key == GLFW_KEY_S || key == GLFW_KEY_D || key == GLFW_KEY_E ||
         key == GLFW_KEY_Q;
}

}  // namespace

// Exceptions must not pass through GLFW, which is C: what a callback does is guarded.
void App::listen() {
  GLFWwindow* window = window_.handle();
  glfwSetWindowUserPointer(window, this);
  glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) { app_of(w)->on_mouse_moved(x, y); });
  glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int modifiers) {
    app_of(w)->on_mouse_button(button, action, modifiers);
  });
  glfwSetScrollCallback(window, [](GLFWwindow* w, double x, double y) {
    App& app = *app_of(w);
    app.panel_dirty_ = true;
    if (!app.desk_->scrolled(x, y)) {
      const bool ctrl =
          glfwGetKey(w, GLFW_KEY_LEFT_CONTROL) == GLFW_PRESS || glfwGetKey(w, GLFW_KEY_RIGHT_CONTROL) == GLFW_PRESS;
      app.on_scrolled(y, ctrl ? GLFW_MOD_CONTROL : 0);
    }
  });
  desk_->key = [this](int key, int action, int modifiers) { return on_key(key, action, modifiers); };
  glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int scancode, int action, int modifiers) {
    App& app = *app_of(w);
    app.panel_dirty_ = true;
    if (action == GLFW_RELEASE) app.flying_.erase(key);
    app.guarded([&] { app.desk_->key_pressed(key, scancode, action, modifiers); });
    app.journal_.focus(*app.desk_);  // several keys may come before the next drawing
  });
  glfwSetCharCallback(window, [](GLFWwindow* w, unsigned codepoint) {
    App& app = *app_of(w);
    app.panel_dirty_ = true;
    app.guarded([&] { app.desk_->character(codepoint); });
  });
  glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int width, int height) {
    App& app = *app_of(w);
    app.framebuffer_width_ = std::max(1, width);
    app.framebuffer_height_ = std::max(1, height);
    app.desk_->resized();
    app.redraws_ = kRedrawsAfterResize;
    app.panel_dirty_ = app.picture_dirty_ = true;
  });
  glfwSetWindowContentScaleCallback(window, [](GLFWwindow* w, float, float) {
    // The window went to another monitor.
    App& app = *app_of(w);
    if (app.options_.ui_scale) return;
    app.desk_->set_ui_scale(app.window_.content_scale());
    app.panel_dirty_ = app.picture_dirty_ = true;
  });
  glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { app_of(w)->panel_dirty_ = true; });
  glfwSetWindowFocusCallback(window, [](GLFWwindow* w, int) { app_of(w)->flying_.clear(); });
}

void App::on_mouse_button(int button, int action, int modifiers) {
  panel_dirty_ = true;
  guarded([&] {
    if (dragging_ < 0 && desk_->mouse_button(button, action, modifiers)) return;
    if (action == GLFW_PRESS && dragging_ < 0) {
      desk_->let_go();
      if (sweep_ && sweep_clicked(pointer_x_ / desk_->ui_scale(), pointer_y_ / desk_->ui_scale())) return;
      dragging_ = button;
      drag_modifiers_ = modifiers;
      const Region at = region();
      const double line = at.x + static_cast<double>(display_.wipe) * at.width;
      drags_wipe_ = effective_display().mode == CompareMode::wipe && button == GLFW_MOUSE_BUTTON_LEFT &&
                    modifiers == 0 && std::abs(pointer_x_ - line) < 10;
      if (button == GLFW_MOUSE_BUTTON_LEFT && (modifiers & GLFW_MOD_CONTROL) != 0) {
        const auto [column, row] = pixel_at_pointer();
        box_ = {column, row, column, row};
      }
    } else if (action == GLFW_RELEASE && button == dragging_) {
      dragging_ = -1;
    }
  });
}

void App::on_mouse_moved(double x, double y) {
  panel_dirty_ = true;
  int window_width = 1, window_height = 1;
  glfwGetWindowSize(window_.handle(), &window_width, &window_height);
  const double to_pixels = static_cast<double>(framebuffer_width_) / std::max(1, window_width);
  const auto dx = static_cast<float>(x * to_pixels - pointer_x_), dy = static_cast<float>(y * to_pixels - pointer_y_);
  pointer_x_ = x * to_pixels;
  pointer_y_ = y * to_pixels;
  guarded([&] {
    if (dragging_ < 0) {
      desk_->mouse_moved(x, y);
      return;
    }
    const bool ctrl = (drag_modifiers_ & GLFW_MOD_CONTROL) != 0, shift = (drag_modifiers_ & GLFW_MOD_SHIFT) != 0;
    if (ctrl && dragging_ != GLFW_MOUSE_BUTTON_LEFT) {
      zoom_.left -= dx / zoom_.scale;
      zoom_.top -= dy / zoom_.scale;
      zoom_.fitted = false;
      picture_dirty_ = true;
      return;
    }
    if (drags_wipe_) {
      const Region at = region();
      display_.wipe = std::clamp(static_cast<float>(pointer_x_ - at.x) / static_cast<float>(at.width), 0.0F, 1.0F);
      picture_dirty_ = true;
      return;
    }
    if (ctrl) {
      const auto [column, row] = pixel_at_pointer();
      box_.x1 = column + 1;
      box_.y1 = row + 1;
      return;
    }
    const std::optional<View> view = workspace_.camera();
    if (!view) return;
    const int height = region().height;
    if ((drag_modifiers_ & GLFW_MOD_ALT) != 0) return drag_object(*view, dx, dy);
    if (dragging_ == GLFW_MOUSE_BUTTON_MIDDLE || (dragging_ == GLFW_MOUSE_BUTTON_LEFT && shift)) {
      move_camera(pan(*view, dx, dy, height));
    } else if (dragging_ == GLFW_MOUSE_BUTTON_RIGHT) {
      move_camera(dolly(*view, (dx - dy) / 20));
    } else if (dragging_ == GLFW_MOUSE_BUTTON_LEFT) {
      move_camera(orbit(*view, dx, dy, height));
    }
  });
}

void App::on_scrolled(double by, int modifiers) {
  guarded([&] {
    if ((modifiers & GLFW_MOD_CONTROL) != 0) {
      const Region at = region();
      zoom_.about(static_cast<float>(pointer_x_) - static_cast<float>(at.x),
                  static_cast<float>(pointer_y_) - static_cast<float>(at.y), by > 0 ? 1.25F : 0.8F);
      picture_dirty_ = true;
    } else if (const std::optional<View> view = workspace_.camera()) {
      move_camera(dolly(*view, static_cast<float>(by)));
    }
  });
}

bool App::on_key(int key, int action, int modifiers) {
  const bool plain = (modifiers & (GLFW_MOD_CONTROL | GLFW_MOD_ALT)) == 0;
  if (plain && flies(key)) {
    if (action == GLFW_PRESS) {
      if (flying_.empty()) flown_s_ = glfwGetTime() - 1.0 / 60;  // a tap moves too
      flying_.insert(key);
    }
    return true;
  }
  if (action != GLFW_PRESS && action != GLFW_REPEAT) return false;
  if (key == GLFW_KEY_ESCAPE && workspace_.busy()) {
    workspace_.cancel();
    return true;
  }
  if (key == GLFW_KEY_ESCAPE && stop_frames()) return true;
  const float turn = (modifiers & GLFW_MOD_SHIFT) != 0 ? 15.0F : 3.0F;
  const std::optional<View> view = workspace_.camera();
  if (view && plain) {
    const float right = key == GLFW_KEY_RIGHT ? turn : key == GLFW_KEY_LEFT ? -turn : 0;
    const float up = key == GLFW_KEY_UP ? turn : key == GLFW_KEY_DOWN ? -turn : 0;
    if (right != 0 || up != 0) {
      move_camera(look(*view, right, up));
      return true;
    }
  }
  return act(key, modifiers);
}

void App::move_camera(const View& view) {
  workspace_.set_camera(view);
  panel_dirty_ = true;
}

void App::drag_object(const View& view, float dx, float dy) {
  std::vector<ParameterInfo> infos;
  for (const Workspace::Group& group : workspace_.groups(Side::a))
    if (group.prefix == "scene.") infos = group.infos;
  std::string name = panel_.last_parameter();
  name = name.starts_with("scene.") ? name.substr(6) : first_placement(infos);
  if (name.empty()) return say("this scene has no parameter that moves a light or an object", true);
  const auto get = [this](const std::string& bare) { return workspace_.get(Side::a, "scene." + bare); };
  for (const auto& [bare, value] : dragged(name, infos, get, view, dx, dy, region().width, region().height))
    workspace_.set(Side::a, "scene." + bare, value);
}

void App::fly() {
  if (flying_.empty()) return;
  const std::optional<View> view = workspace_.camera();
  const double now = glfwGetTime();
  const bool shift = glfwGetKey(window_.handle(), GLFW_KEY_LEFT_SHIFT) == GLFW_PRESS;
  const auto by = static_cast<float>(std::min(0.1, now - flown_s_) * (shift ? 2.5 : 0.5));
  flown_s_ = now;
  if (!view) return;
  const auto held = [this](int key) { return flying_.contains(key) ? 1.0F : 0.0F; };
  const glm::vec3 along(held(GLFW_KEY_D) - held(GLFW_KEY_A), held(GLFW_KEY_E) - held(GLFW_KEY_Q),
                        held(GLFW_KEY_W) - held(GLFW_KEY_S));
  if (along != glm::vec3(0)) move_camera(sandbox::fly(*view, by * along));
}

}  // namespace pellucid::sandbox
