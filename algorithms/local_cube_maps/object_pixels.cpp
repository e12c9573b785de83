#include "algorithms/local_cube_maps/object_pixels.hpp"

namespace pellucid::local_cube_maps {
namespace {

constexpr unsigned kUnit = 9;  // surface_point.glsl

}  // namespace

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
    surfaces_ = gl::Program(
        "object pixels", {"algorithms/shaders/opaque.vert.glsl", "algorithms/local_cube_maps/object_pixels.frag.glsl"});
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
  fill_area(area, fullscreen_);
}

}  // namespace pellucid::local_cube_maps
