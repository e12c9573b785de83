#include "algorithms/distance_impostors/object_pixels.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pellucid::distance_impostors {
namespace {

constexpr unsigned kUnit = 9;               // surface_point.glsl
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

void ObjectPixels::begin(const gl::Texture& depth) {
  if (!pixels_ || pixels_.width() != depth.width() || pixels_.height() != depth.height()) {
    pixels_ = gl::Texture::make_2d("object pixels", gl::Format::rgba32f, depth.width(), depth.height());
    pixels_.set_sampling(gl::Filter::nearest, gl::Wrap::clamp);
    framebuffer_ = gl::Framebuffer("object pixels", {&pixels_}, &depth);
    if (fullscreen_.id() == 0) fullscreen_ = gl::VertexArray("object pixels");
  }
  // Another texture of the same size, and even of the same name, may have come in the stead of the last frame's.
  glNamedFramebufferTexture(framebuffer_.id(), GL_DEPTH_ATTACHMENT, depth.id(), 0);
  framebuffer_.bind();
}

void ObjectPixels::clear(const PixelArea& area) const {
  glEnable(GL_SCISSOR_TEST);
  glScissor(area.x, area.y, area.width, area.height);
  framebuffer_.clear_color(0, {0, 0, 0, 0});
  glDisable(GL_SCISSOR_TEST);
}

const gl::Program& ObjectPixels::surfaces(const Camera& camera, int number) {
  if (!surfaces_) {
    surfaces_ = gl::Program("object pixels", {"algorithms/shaders/common/opaque.vert.glsl",
                                              "algorithms/distance_impostors/object_pixels.frag.glsl"});
  }
  surfaces_.set("eye", camera.view.eye);
  surfaces_.set("object_number", number);
  return surfaces_;
}

void ObjectPixels::bind(const gl::Program& program, const Camera& camera, int number) const {
  pixels_.bind(kUnit);
  program.set("eye", camera.view.eye);
  program.set("object_number", number);
  // From clip space's x and y to a ray, without the cancellation that the inverse of the projection has.
  const glm::mat4 projection = camera.projection();
  const glm::mat3 to_world = glm::transpose(glm::mat3(camera.world_to_view()));
  program.set("clip_to_ray", glm::mat3(to_world[0] / projection[0][0], to_world[1] / projection[1][1], -to_world[2]));
}

void ObjectPixels::fill(const PixelArea& area) const {
  glEnable(GL_SCISSOR_TEST);
  glScissor(area.x, area.y, area.width, area.height);
  // What lies beyond the object is not the object: the depth test leaves it out before any shading.
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GEQUAL);
  glDepthMask(GL_FALSE);
  glDepthRangef(area.farthest, area.farthest);
  fullscreen_.bind();
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDepthRangef(0, 1);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LEQUAL);
  glDisable(GL_SCISSOR_TEST);
}

}  // namespace pellucid::distance_impostors
