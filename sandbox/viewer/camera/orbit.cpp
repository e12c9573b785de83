#include "sandbox/viewer/camera/orbit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/gtc/quaternion.hpp>

namespace pellucid::sandbox {
namespace {

constexpr float kLeastPole = 0.02F;  // radians between the view and its up direction

struct Frame {
  glm::vec3 forward, right, up;
  float distance = 1;
};

Frame frame_of(const View& view) {
  Frame frame;
  frame.distance = glm::length(view.target - view.eye);
  frame.forward = (view.target - view.eye) / frame.distance;
  frame.right = glm::normalize(glm::cross(frame.forward, view.up));
  frame.up = glm::cross(frame.right, frame.forward);
  return frame;
}

/// `forward` turned about the up direction by `yaw` and towards it by `pitch` [radians].
glm::vec3 turned(const View& view, const Frame& frame, float yaw, float pitch) {
  const glm::vec3 pole = glm::normalize(view.up);
  const float angle = std::acos(std::clamp(glm::dot(frame.forward, pole), -1.0F, 1.0F));
  const float wanted = std::clamp(angle - pitch, kLeastPole, std::numbers::pi_v<float> - kLeastPole);
  const glm::vec3 pitched = glm::angleAxis(angle - wanted, frame.right) * frame.forward;
  return glm::normalize(glm::angleAxis(-yaw, pole) * pitched);
}

}  // namespace

View orbit(const View& view, float dx_px, float dy_px, int height_px) {
  const Frame frame = frame_of(view);
  const float per_pixel = std::numbers::pi_v<float> / static_cast<float>(std::max(1, height_px));
  View moved = view;
  moved.eye = view.target - frame.distance * turned(view, frame, dx_px * per_pixel, -dy_px * per_pixel);
  return moved;
}

View pan(const View& view, float dx_px, float dy_px, int height_px) {
  const Frame frame = frame_of(view);
  const float per_pixel =
      2 * frame.distance * std::tan(glm::radians(view.fov_y_deg) / 2) / static_cast<float>(std::max(1, height_px));
  const glm::vec3 by = per_pixel * (dy_px * frame.up - dx_px * frame.right);
  View moved = view;
  moved.eye += by;
  moved.target += by;
  return moved;
}

View dolly(const View& view, float steps) {
  View moved = view;
  moved.eye = view.target + (view.eye - view.target) * std::pow(0.9F, steps);
  return moved;
}

View fly(const View& view, const glm::vec3& right_up_forward) {
  const Frame frame = frame_of(view);
  const glm::vec3 by = frame.distance * (right_up_forward.x * frame.right + right_up_forward.y * frame.up +
                                         right_up_forward.z * frame.forward);
  View moved = view;
  moved.eye += by;
  moved.target += by;
  return moved;
}

View look(const View& view, float right_deg, float up_deg) {
  const Frame frame = frame_of(view);
  View moved = view;
  moved.target = view.eye + frame.distance * turned(view, frame, glm::radians(right_deg), glm::radians(up_deg));
  return moved;
}

}  // namespace pellucid::sandbox
