#include "algorithms/raster/pixel_area.hpp"

#include <algorithm>
#include <cmath>

namespace pellucid {
namespace {

constexpr float kDepthRounding = 0x1p-20F;  // of a depth in the pass that wrote it, and more

}  // namespace

std::optional<PixelArea> seen_area(const glm::mat4& box_to_clip, const Bounds& box, int width, int height) {
  glm::vec3 low(1.0F), high(-1.0F);
  for (int i = 0; i < 8; ++i) {
    const glm::vec4 p = box_to_clip * glm::vec4(box.corner(i), 1.0F);
    // Behind or beside the eye a corner's place bounds nothing.
    if (p.z < -p.w || p.w <= 0) {
      low = glm::vec3(-1.0F);
      high = glm::vec3(1.0F);
      break;
    }
    low = glm::min(low, glm::vec3(p) / p.w);
    high = glm::max(high, glm::vec3(p) / p.w);
  }
  low = glm::max(low, glm::vec3(-1.0F));
  high = glm::min(high, glm::vec3(1.0F));
  if (low.x > high.x || low.y > high.y) return std::nullopt;
  const glm::vec2 size(static_cast<float>(width), static_cast<float>(height));
  // A pixel more on each side outweighs rounding.
  const glm::ivec2 first = glm::max(glm::ivec2(glm::floor((0.5F * glm::vec2(low) + 0.5F) * size)) - 1, glm::ivec2(0));
  const glm::ivec2 last =
      glm::min(glm::ivec2(glm::ceil((0.5F * glm::vec2(high) + 0.5F) * size)) + 1, glm::ivec2(width, height));
  return PixelArea{first.x, first.y, last.x - first.x, last.y - first.y,
                   std::min(0.5F * high.z + 0.5F + kDepthRounding, 1.0F)};
}

void fill_area(const PixelArea& area, const gl::VertexArray& fullscreen) {
  glEnable(GL_SCISSOR_TEST);
  glScissor(area.x, area.y, area.width, area.height);
  // A fragment beyond the object is not the object's: the depth test leaves it out before any shading.
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GEQUAL);
  glDepthMask(GL_FALSE);
  glDepthRangef(area.farthest, area.farthest);
  fullscreen.bind();
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDepthRangef(0, 1);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LEQUAL);
  glDisable(GL_SCISSOR_TEST);
}

}  // namespace pellucid
