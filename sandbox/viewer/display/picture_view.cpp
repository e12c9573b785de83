#include "sandbox/viewer/display/picture_view.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <epoxy/gl.h>
#include <glm/glm.hpp>

#include "gl/context.hpp"
#include "sweeps/metrics/flip.hpp"

namespace pellucid::sandbox {
namespace {

constexpr const char* kFullscreen = "algorithms/shaders/fullscreen.vert.glsl";
constexpr const char* kPicture = "sandbox/viewer/display/picture.frag.glsl";
const glm::vec3 kGround(0.11F, 0.115F, 0.125F);

void switch_off_tests() {
  for (const int test : {GL_BLEND, GL_DEPTH_TEST, GL_STENCIL_TEST, GL_SCISSOR_TEST, GL_CULL_FACE})
    glDisable(static_cast<GLenum>(test));
}

struct Rectangle {
  int x = 0, y = 0, width = 0, height = 0;
};

/// Where pixels of the picture lie within the region, in GL's order of rows.
Rectangle picture_within(const Region& region, const Zoom& zoom, const gl::Texture& picture) {
  const auto at = [&](float texel, float origin, int room) {
    return std::clamp((texel - origin) * zoom.scale, 0.0F, static_cast<float>(room));
  };
  const auto low = [&](float origin, int room) { return static_cast<int>(std::floor(at(0, origin, room))); };
  const auto high = [&](int size, float origin, int room) {
    return static_cast<int>(std::ceil(at(static_cast<float>(size), origin, room)));
  };
  const int left = low(zoom.left, region.width), right = high(picture.width(), zoom.left, region.width);
  const int top = low(zoom.top, region.height), bottom = high(picture.height(), zoom.top, region.height);
  return {left, region.height - bottom, right - left, bottom - top};
}

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
      window_("window", {kFullscreen, "sandbox/viewer/display/window.frag.glsl"}),
      triangle_("window") {
  set_transform({}, {}, {});
  set_a(Image(1, 1, 4));
  set_b(Image(1, 1, 4));
}

void PictureView::set_transform(const std::string& display, const std::string& view, const std::string& look) {
  transform_ = gl::DisplayTransform(display, view, look);
  plain_ = transform_->program("picture", kFullscreen, kPicture, {{"PLAIN", "1"}});
  full_ = transform_->program("pictures", kFullscreen, kPicture);
  drawn_.reset();
}

const gl::Program& PictureView::program_for(const DisplaySettings& settings) const {
  const bool plain = settings.mode == CompareMode::a && settings.channel < 0 && !settings.warn &&
                     !settings.false_color && !settings.encoded;
  return plain ? plain_ : full_;
}

void PictureView::upload(const Image& image, gl::Texture& texture, const char* label) {
  drawn_.reset();
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

void PictureView::draw(const DisplaySettings& settings, const Region& region, const Zoom& zoom) {
  const Drawn wanted{settings, region, zoom};
  if (drawn_ == wanted) return;
  drawn_ = wanted;
  if (!displayed_ || displayed_.width() != region.width || displayed_.height() != region.height) {
    displayed_ = gl::Texture::make_2d("displayed picture", gl::Format::rgba8, region.width, region.height);
    displayed_framebuffer_ = gl::Framebuffer("displayed picture", {&displayed_});
  }
  const gl::Program& program = program_for(settings);
  displayed_framebuffer_.bind();
  switch_off_tests();
  program.use();
  program.set("origin", glm::vec2(zoom.left, zoom.top));
  program.set("per_pixel", 1 / zoom.scale);
  program.set("region", glm::ivec2(region.width, region.height));
  program.set("exposure", std::exp2(settings.exposure_ev));
  program.set("ground", kGround);
  program.set("mode", static_cast<int>(settings.mode));
  program.set("wipe", settings.wipe);
  program.set("gain", settings.gain);
  program.set("channel", settings.channel);
  program.set("warn", settings.warn);
  program.set("false_color", settings.false_color);
  program.set("encoded", settings.encoded);
  a_.bind(0);
  b_.bind(1);
  ramp_.bind(2);
  transform_->bind_luts();
  triangle_.bind();
  if (settings.mode == CompareMode::a) {
    // Around the picture there is nothing to transform.
    displayed_framebuffer_.clear_color(0, {kGround.x, kGround.y, kGround.z, 1});
    const Rectangle within = picture_within(region, zoom, a_);
    glScissor(within.x, within.y, within.width, within.height);
    glEnable(GL_SCISSOR_TEST);
  }
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDisable(GL_SCISSOR_TEST);
  gl::check("draw", "picture");
}

void PictureView::show(const Region& region, const gl::Texture& layer) const {
  glViewport(0, 0, layer.width(), layer.height());
  switch_off_tests();
  window_.use();
  window_.set("corner", glm::ivec2(region.x, layer.height() - region.y - region.height));
  window_.set("any_picture", static_cast<bool>(displayed_));
  window_.set("ground", kGround);
  (displayed_ ? displayed_ : ramp_).bind(0);
  layer.bind(1);
  triangle_.bind();
  glDrawArrays(GL_TRIANGLES, 0, 3);
  gl::check("draw", "window");
}

std::string PictureView::reload_shaders() {
  drawn_.reset();
  return plain_.reload() + full_.reload() + window_.reload();
}

}  // namespace pellucid::sandbox
