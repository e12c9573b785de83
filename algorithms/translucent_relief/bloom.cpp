#include "algorithms/translucent_relief/bloom.hpp"

namespace pellucid::translucent_relief {
namespace {

const std::string kFullscreen = "algorithms/shaders/fullscreen.vert.glsl";
const std::string kBloomFolder = "algorithms/translucent_relief/";

}  // namespace

void Bloom::fit(int width, int height) {
  if (first_ && first_.width() == width && first_.height() == height) return;
  first_ = gl::Texture::make_2d("bloom", gl::Format::rgba16f, width, height);
  second_ = gl::Texture::make_2d("blurred bloom", gl::Format::rgba16f, width, height);
  first_.set_sampling(gl::Filter::linear, gl::Wrap::clamp);
  first_target_ = gl::Framebuffer("bloom", {&first_});
  second_target_ = gl::Framebuffer("blurred bloom", {&second_});
  if (bright_) return;
  bright_ = gl::Program("bright light", {kFullscreen, kBloomFolder + "bright.frag.glsl"});
  blur_ = gl::Program("blurred light", {kFullscreen, kBloomFolder + "blur.frag.glsl"});
  add_ = gl::Program("bloom", {kFullscreen, kBloomFolder + "bloom.frag.glsl"});
  fullscreen_ = gl::VertexArray("bloom fullscreen");
}

void Bloom::add(const Target& target, const BloomSettings& settings) {
  const int width = target.color.width(), height = target.color.height(), block = settings.downsampling;
  fit((width + block - 1) / block, (height + block - 1) / block);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  const auto draw = [&](const gl::Framebuffer& into, const gl::Texture& from, const gl::Program& program) {
    into.bind();
    from.bind(0);
    program.use();
    fullscreen_.bind();
    glDrawArrays(GL_TRIANGLES, 0, 3);
  };
  bright_.set("block", block);
  bright_.set("threshold", settings.threshold);
  draw(first_target_, target.color, bright_);
  blur_.set("sigma", settings.sigma);
  blur_.set("direction", glm::ivec2(1, 0));
  draw(second_target_, first_, blur_);
  blur_.set("direction", glm::ivec2(0, 1));
  draw(first_target_, second_, blur_);

  add_.set("pixels", glm::vec2(width, height));
  add_.set("strength", settings.strength);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  glDepthMask(GL_FALSE);
  draw(target.framebuffer, first_, add_);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
}

std::string Bloom::reload_shaders() {
  std::string words;
  for (gl::Program* program : {&bright_, &blur_, &add_}) {
    if (*program) words += program->reload();
  }
  return words;
}

}  // namespace pellucid::translucent_relief
