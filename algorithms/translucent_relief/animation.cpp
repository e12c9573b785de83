#include "algorithms/translucent_relief/animation.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

namespace pellucid::translucent_relief {
namespace {

const std::string kFolder = "algorithms/translucent_relief/";

void compile(gl::Program& program, const char* label, const char* file) {
  if (!program) program = gl::Program(label, {kFolder + file});
}

// Groups of 8 × 8 threads over a texture.
void dispatch_over(const gl::Texture& texture) {
  glDispatchCompute(static_cast<GLuint>((texture.width() + 7) / 8), static_cast<GLuint>((texture.height() + 7) / 8), 1);
  glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

}  // namespace

void Animation::run(const ReliefMotion& motion, const gl::Texture& heights, const gl::Texture& slopes) {
  if (!motion.sines.empty()) {
    compile(waves_, "waves", "waves.comp.glsl");
    sines_ = gl::Buffer("sines", std::span<const Sine>(motion.sines));
    sines_.bind_storage(0);
    heights.bind_image(0, GL_WRITE_ONLY);
    waves_.use();
    waves_.set("time_s", static_cast<float>(motion.time_s));
    dispatch_over(heights);
  } else {
    assert(motion.ground_m.width == heights.width() && motion.ground_m.height == heights.height());
    compile(rain_, "rain", "rain.comp.glsl");
    compile(rain_surface_, "rain surface", "rain_surface.comp.glsl");
    drops_ = gl::Buffer("drops", static_cast<std::size_t>(motion.rain.drops) * sizeof(RainDrop));
    drops_.bind_storage(0);
    rain_.use();
    rain_.set("seed", static_cast<int>(motion.rain.seed));
    rain_.set("count", motion.rain.drops);
    rain_.set("largest", motion.rain.largest);
    rain_.set("fall", motion.rain.fall);
    // llvmpipe ends a shader's loops after 65,535 rounds in all: a few steps at a time, each of three loops over drops.
    const int most = std::max(1, 16384 / motion.rain.drops);
    for (int first = 0; first == 0 || first < motion.steps; first += most) {
      rain_.set("first_step", first);
      rain_.set("steps", std::min(most, motion.steps - first));
      glDispatchCompute(1, 1, 1);
      glMemoryBarrier(GL_ALL_BARRIER_BITS);
    }
    ground_ = gl::Texture::make_2d("ground of drops", gl::Format::r32f, motion.ground_m.width, motion.ground_m.height);
    ground_.upload(motion.ground_m.pixels);
    ground_.bind(0);
    heights.bind_image(0, GL_WRITE_ONLY);
    rain_surface_.use();
    rain_surface_.set("count", motion.rain.drops);
    rain_surface_.set("largest", motion.rain.largest);
    rain_surface_.set("below_m", motion.below_m);
    rain_surface_.set("top_m", motion.top_m);
    rain_surface_.set("height_m", motion.height_m);
    dispatch_over(heights);
  }
  compile(slopes_, "slopes", "slopes.comp.glsl");
  heights.bind(0);
  slopes.bind_image(0, GL_WRITE_ONLY);
  slopes_.use();
  dispatch_over(slopes);
}

std::vector<RainDrop> Animation::read_drops() const {
  const std::vector<std::byte> bytes = drops_.read();
  std::vector<RainDrop> drops(bytes.size() / sizeof(RainDrop));
  std::memcpy(drops.data(), bytes.data(), drops.size() * sizeof(RainDrop));
  return drops;
}

std::string Animation::reload_shaders() {
  std::string words;
  for (gl::Program* program : {&waves_, &rain_, &rain_surface_, &slopes_}) {
    if (*program) words += program->reload();
  }
  return words;
}

}  // namespace pellucid::translucent_relief
