#include "sweeps/bench/ceilings.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "gl/objects.hpp"
#include "gl/program.hpp"
#include "sweeps/measure/frame_clock.hpp"
#include "sweeps/measure/stopping.hpp"

namespace pellucid::sweeps {
namespace {

using gl::Filter;
using gl::Format;

constexpr int kFetches = 64;
constexpr int kLayers = 16;
constexpr int kDispatches = 64;
constexpr double kLongEnough_ms = 2;
constexpr int kLargest = 2048;
constexpr int kFrames = 9;

/// Median time of a frame, the first ones apart.
double frame_ms(const std::function<void()>& draw, int frames) {
  FrameClock clock;
  std::vector<double> times;
  const FrameClock::Draw subject = [&](gl::PassTimer& timer) {
    timer.begin_frame();
    {
      const gl::PassTimer::Pass pass = timer.pass("ceiling");
      draw();
    }
    timer.end_frame();
  };
  for (int i = 0; i < 2; ++i)
    clock.draw(subject, nullptr);
  for (int i = 0; i < frames; ++i)
    clock.draw(subject, &times);
  clock.drain();
  std::sort(times.begin(), times.end());
  return quantile(times, 0.5);
}

/// Per second of `each(side)` things that `draw` does in a square of `side` pixels, large enough to be timed.
double rate(const std::function<double(int)>& each, const std::function<std::function<void()>(int)>& draw) {
  for (int side = 128;; side *= 2) {
    const std::function<void()> frame = draw(side);
    const bool enough = frame_ms(frame, 1) >= kLongEnough_ms || side >= kLargest;
    if (enough) return each(side) / (frame_ms(frame, kFrames) / 1000);
  }
}

double square(int side) {
  return static_cast<double>(side) * side;
}

/// Binds a framebuffer of the size and a full-screen triangle.
struct Stage {
  gl::Texture color;
  gl::Framebuffer framebuffer;
  gl::VertexArray triangle{"ceiling"};
  Stage(Format format, int side)
      : color(gl::Texture::make_2d("ceiling", format, side, side)), framebuffer("ceiling", {&color}) {}
  void draw(int layers) const {
    framebuffer.bind();
    triangle.bind();
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    for (int i = 0; i < layers; ++i)
      glDrawArrays(GL_TRIANGLES, 0, 3);
  }
};

double fetches(Format format, Filter filter) {
  const gl::Program program("ceiling of fetches",
                            {"algorithms/shaders/fullscreen.vert.glsl", "sweeps/bench/ceilings_fetch.frag.glsl"},
                            {{"FETCHES", std::to_string(kFetches)}});
  constexpr int kSource = 512;
  gl::Texture source = gl::Texture::make_2d("ceiling's source", format, kSource, kSource);
  source.clear({0.5F, 0.25F, 0.75F, 1.0F});
  source.set_sampling(filter, gl::Wrap::repeat);
  return rate([](int side) { return square(side) * kFetches; },
              [&](int side) {
                auto stage = std::make_shared<Stage>(Format::rgba8, side);
                return [&, stage] {
                  glDisable(GL_BLEND);
                  program.use();
                  source.bind(0);
                  stage->draw(1);
                };
              });
}

double fills(Format format, bool blend) {
  const gl::Program program("ceiling of fills",
                            {"algorithms/shaders/fullscreen.vert.glsl", "sweeps/bench/ceilings_fill.frag.glsl"});
  const double result = rate([](int side) { return square(side) * kLayers; },
                             [&](int side) {
                               auto stage = std::make_shared<Stage>(format, side);
                               return [&, stage] {
                                 program.use();
                                 program.set("value", glm::vec4(0.1F, 0.2F, 0.3F, 0.5F));
                                 if (blend)
                                   glEnable(GL_BLEND);
                                 else
                                   glDisable(GL_BLEND);
                                 glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
                                 stage->draw(kLayers);
                               };
                             });
  glDisable(GL_BLEND);
  return result;
}

double dispatches() {
  const gl::Program program("ceiling of dispatches", {"sweeps/bench/ceilings_empty.comp.glsl"});
  const gl::Buffer sink("ceiling", 256);
  return rate([](int side) { return static_cast<double>(kDispatches) * side / 128; },
              [&](int side) {
                return [&, side] {
                  program.use();
                  program.set("never", 0);
                  sink.bind_storage(0);
                  for (int i = 0; i < kDispatches * side / 128; ++i)
                    glDispatchCompute(1, 1, 1);
                };
              });
}

double uploads() {
  return rate([](int side) { return square(side) * 16; },
              [&](int side) {
                auto texture = std::make_shared<gl::Texture>(
                    gl::Texture::make_2d("ceiling's upload", Format::rgba32f, side, side));
                auto texels = std::make_shared<std::vector<float>>(static_cast<std::size_t>(square(side)) * 4, 0.5F);
                return [texture, texels] { texture->upload(*texels); };
              });
}

}  // namespace

std::vector<Ceiling> measure_ceilings() {
  std::vector<Ceiling> result;
  for (const Format format : {Format::r8, Format::rgba8, Format::rgba16f, Format::rgba32f}) {
    for (const Filter filter : {Filter::nearest, Filter::linear}) {
      result.push_back({"fetches",
                        std::string(gl::name(format)) + (filter == Filter::linear ? ", linear" : ", nearest"),
                        fetches(format, filter), "Gfetch/s", 1e9});
    }
  }
  for (const bool blend : {false, true}) {
    for (const Format format : {Format::rgba8, Format::rgba16f, Format::rgba32f})
      result.push_back({blend ? "blends" : "fill", gl::name(format), fills(format, blend), "Gpixel/s", 1e9});
  }
  result.push_back({"dispatches", "one group of 64", dispatches(), "k/s", 1e3});
  result.push_back({"uploads", "rgba32f", uploads(), "GB/s", 1e9});
  return result;
}

}  // namespace pellucid::sweeps
