#include "sandbox/viewer/display/picture_view.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <epoxy/gl.h>

#include "gl/context.hpp"
#include "sweeps/metrics/flip.hpp"

namespace pellucid::sandbox {
namespace {

constexpr const char* kFullscreen = "algorithms/shaders/fullscreen.vert.glsl";

// FLIP's own colours, so that all maps of the window share one scale.
gl::Texture make_ramp() {
  constexpr int kColors = 256;
  Image shares(kColors, 1, 1);
  for (int i = 0; i < kColors; ++i)
    *shares.at(i, 0) = static_cast<float>(i) / (kColors - 1);
  const Image colors = sweeps::error_colors(shares);
  std::vector<float> texels;
  for (int i = 0; i < kColors; ++i)
    texels.insert(texels.end(), {colors.at(i, 0)[0], colors.at(i, 0)[1], colors.at(i, 0)[2], 1.0F});
  gl::Texture ramp = gl::Texture::make_2d("ramp of colours", gl::Format::rgba32f, kColors, 1);
  ramp.upload(texels);
  ramp.set_sampling(gl::Filter::linear, gl::Wrap::clamp);
  return ramp;
}

}  // namespace

void Zoom::fit(const Region& region, int width, int height, CompareMode mode) {
  const float room_x = static_cast<float>(mode == CompareMode::side_by_side ? region.width / 2 : region.width);
  const auto room_y = static_cast<float>(region.height);
  const auto of_x = static_cast<float>(width), of_y = static_cast<float>(height);
  scale = std::min({1.0F, room_x / of_x, room_y / of_y});
  // Whole pixels at 1:1, so that a pixel of the picture is one of the window.
  left = std::floor((of_x - room_x / scale) / 2);
  top = std::floor((of_y - room_y / scale) / 2);
  fitted = true;
}

void Zoom::about(float x, float y, float factor) {
  const float at_x = left + x / scale, at_y = top + y / scale;
  scale = std::clamp(scale * factor, 1.0F / 64, 128.0F);
  left = at_x - x / scale;
  top = at_y - y / scale;
  fitted = false;
}

PictureView::PictureView()
    : ramp_(make_ramp()),
      compose_("compose pictures", {kFullscreen, "sandbox/viewer/display/compose.frag.glsl"}),
      overlay_("over the picture", {kFullscreen, "sandbox/viewer/display/overlay.frag.glsl"}),
      layer_("panel's layer", {kFullscreen, "sandbox/viewer/display/layer.frag.glsl"}),
      triangle_("window") {
  transform_.emplace();
  set_a(Image(1, 1, 4));
  set_b(Image(1, 1, 4));
}

void PictureView::set_transform(const std::string& display, const std::string& view, const std::string& look) {
  transform_ = gl::DisplayTransform(display, view, look);
}

void PictureView::upload(const Image& image, gl::Texture& texture, const char* label) {
  const bool fits = texture && texture.width() == image.width && texture.height() == image.height;
  if (!fits) texture = gl::Texture::make_2d(label, gl::Format::rgba32f, image.width, image.height);
  // Rows stay as they are, from the top: the shader knows.
  if (image.channels == 4) {
    texture.upload(image.pixels);
    return;
  }
  std::vector<float> texels;
  texels.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 4);
  const auto channels = static_cast<std::size_t>(image.channels);
  for (std::size_t i = 0; i + channels <= image.pixels.size(); i += channels) {
    const float* p = image.pixels.data() + i;
    const bool grey = channels < 3;
    texels.insert(texels.end(), {p[0], grey ? p[0] : p[1], grey ? p[0] : p[2], 1.0F});
  }
  texture.upload(texels);
}

void PictureView::set_viewport(const Region& region, int framebuffer_height) const {
  glViewport(region.x, framebuffer_height - region.y - region.height, region.width, region.height);
}

void PictureView::draw(const DisplaySettings& settings, const Region& region, const Zoom& zoom,
                       int framebuffer_height) {
  if (!composed_ || composed_.width() != region.width || composed_.height() != region.height) {
    composed_ = gl::Texture::make_2d("composed picture", gl::Format::rgba32f, region.width, region.height);
    composed_framebuffer_ = gl::Framebuffer("composed picture", {&composed_});
  }
  GLint target = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &target);
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_STENCIL_TEST);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_CULL_FACE);
  composed_framebuffer_.bind();
  compose_.use();
  compose_.set("origin", glm::vec2(zoom.left, zoom.top));
  compose_.set("per_pixel", 1 / zoom.scale);
  compose_.set("region", glm::ivec2(region.width, region.height));
  compose_.set("mode", static_cast<int>(settings.mode));
  compose_.set("wipe", settings.wipe);
  compose_.set("gain", settings.gain);
  compose_.set("channel", settings.channel);
  a_.bind(0);
  b_.bind(1);
  triangle_.bind();
  glDrawArrays(GL_TRIANGLES, 0, 3);

  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(target));
  set_viewport(region, framebuffer_height);
  if (!settings.encoded && !settings.false_color) transform_->draw(composed_, settings.exposure_ev);
  // gl_FragCoord counts from the window's corner; the overlay reads the composed picture from its own.
  overlay_.use();
  overlay_.set("corner", glm::ivec2(region.x, framebuffer_height - region.y - region.height));
  overlay_.set("warn", settings.warn);
  overlay_.set("false_color", settings.false_color);
  overlay_.set("encoded", settings.encoded);
  overlay_.set("exposure_ev", settings.exposure_ev);
  composed_.bind(0);
  ramp_.bind(1);
  triangle_.bind();
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDisable(GL_BLEND);
  gl::check("draw", "picture");
}

void PictureView::draw_layer(const gl::Texture& layer) const {
  glViewport(0, 0, layer.width(), layer.height());
  layer_.use();
  layer.bind(0);
  triangle_.bind();
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDisable(GL_BLEND);
  gl::check("draw", "panel's layer");
}

std::string PictureView::reload_shaders() {
  return compose_.reload() + overlay_.reload() + layer_.reload();
}

}  // namespace pellucid::sandbox
