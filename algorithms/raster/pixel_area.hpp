#pragma once

#include <optional>

#include <glm/glm.hpp>

#include "algorithms/scene/shapes/bounds.hpp"
#include "gl/objects.hpp"

namespace pellucid {

/// A part of the frame [pixels], from the bottom left, up to a depth of the depth buffer.
struct PixelArea {
  int x = 0, y = 0, width = 0, height = 0;
  float farthest = 1;
};
/// Where a box may be seen in a frame of that size; nothing where it is not.
std::optional<PixelArea> seen_area(const glm::mat4& box_to_clip, const Bounds& box, int width, int height);

/// Runs the program in use, behind fullscreen.vert.glsl, once for each pixel of the area where the bound framebuffer's
/// depth is not beyond it. Depth is not written.
void fill_area(const PixelArea&, const gl::VertexArray& fullscreen);

}  // namespace pellucid
