#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "algorithms/scene/scene.hpp"
#include "algorithms/scene/shapes/procedural.hpp"
#include "algorithms/shaders/optics.hpp"

/// A ball in a round room whose wall shows the direction from its middle as a colour, and what its pixels see, in
/// closed form.
namespace pellucid::test {

inline constexpr double kRoomRadius = 4;
inline constexpr double kBallRadius = 0.8;

inline glm::dvec3 wall_color(const glm::dvec3& direction) {
  return 0.5 + 0.45 * glm::normalize(direction);
}

inline Scene round_room(const Material& material, const glm::vec3& ball = glm::vec3(0)) {
  Scene scene;
  scene.name = "round_room";
  Mesh room = make_sphere(static_cast<float>(kRoomRadius), 256);
  for (const glm::vec3& p : room.positions)
    room.colors.emplace_back(wall_color(p));
  scene.meshes = {std::move(room), make_sphere(static_cast<float>(kBallRadius), 256)};
  scene.materials = {{.name = "wall", .albedo = glm::vec3(1)}, material};
  scene.instances = {{.name = "room", .mesh = 0, .material = 0},
                     {.name = "ball", .mesh = 1, .material = 1, .to_world = glm::translate(glm::mat4(1), ball)}};
  scene.ambient = glm::vec3(1);
  scene.views = {
      {.name = "front", .eye = {0.2F, 0.4F, 2.8F}, .target = ball, .fov_y_deg = 40, .near_m = 0.02F, .far_m = 20},
      {.name = "inside",
       .eye = ball,
       .target = ball + glm::vec3(0.3F, 0.2F, -1),
       .fov_y_deg = 60,
       .near_m = 0.02F,
       .far_m = 20}};
  return scene;
}

/// Where a ray from inside a sphere about the origin leaves it.
inline glm::dvec3 leave_sphere(const glm::dvec3& x, const glm::dvec3& R, double radius) {
  const double along = glm::dot(x, R);
  return x + R * (std::sqrt(along * along - glm::dot(x, x) + radius * radius) - along);
}
inline glm::dvec3 room_light(const glm::dvec3& x, const glm::dvec3& R) {
  return wall_color(leave_sphere(x, R, kRoomRadius));
}

/// The outside of the ball, about `ball`, on a ray; nothing where it is missed.
inline std::optional<glm::dvec3> meet_ball(const glm::dvec3& eye, const glm::dvec3& V, const glm::dvec3& ball) {
  const glm::dvec3 o = eye - ball;
  const double along = glm::dot(o, V), root = along * along - glm::dot(o, o) + kBallRadius * kBallRadius;
  if (root < 0 || along > 0) return std::nullopt;
  return eye + V * (-along - std::sqrt(root));
}

/// A ray that is in the ball at `x`, on its surface or not, with what leaves after 0, 1, … `reflections` reflections;
/// with the last all that is left leaves.
inline glm::dvec3 light_through(glm::dvec3 x, glm::dvec3 R, double ior, int reflections, const glm::dvec3& ball) {
  glm::dvec3 light(0);
  double left = 1;
  for (int i = 0; i <= reflections; ++i) {
    x = ball + leave_sphere(x - ball, R, kBallRadius);
    const glm::dvec3 outward = (x - ball) / kBallRadius;
    const double cosine = glm::dot(R, outward), share = fresnel_dielectric(std::min(cosine, 1.0), ior);
    const auto out = refracted(R, -outward, ior);
    if (out) light += left * (i == reflections ? 1 : 1 - share) * room_light(x, *out);
    left *= share;
    R = reflected(R, outward);
  }
  return light;
}

}  // namespace pellucid::test
