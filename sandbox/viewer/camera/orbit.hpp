#pragma once

#include <glm/glm.hpp>

#include "algorithms/scene/scene.hpp"

/// Moves of a camera about its target, and through the scene. Each gives the view anew; none changes the lens.
namespace pellucid::sandbox {

/// Turns the eye about the target by pixels dragged: a drag over the picture's height is half a turn. The horizon stays
/// level, and the view stops short of the poles.
View orbit(const View&, float dx_px, float dy_px, int height_px);
/// Moves eye and target so that what lies in the target's plane follows the pointer.
View pan(const View&, float dx_px, float dy_px, int height_px);
/// Nearer (steps above 0) or farther, by 10 % of the distance to the target each step; the target stays.
View dolly(const View&, float steps);
/// Through the scene: to the right, up and forward, as shares of the distance to the target.
View fly(const View&, const glm::vec3& right_up_forward);
/// Turns the view about the eye, by degrees to the right and up.
View look(const View&, float right_deg, float up_deg);

}  // namespace pellucid::sandbox
