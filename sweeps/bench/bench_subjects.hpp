#pragma once

#include <array>
#include <span>
#include <vector>

#include "algorithms/render_session.hpp"
#include "sweeps/bench/bench.hpp"
#include "sweeps/bench/bench_reference.hpp"
#include "sweeps/measure/frame_clock.hpp"

namespace pellucid::sweeps {

/// What a bench's frames are drawn into, of the camera's size.
struct BenchTarget {
  BenchTarget(const Camera& camera, gl::Format format)
      : color(gl::Texture::make_2d("bench colour", format, camera.width, camera.height)),
        depth(gl::Texture::make_2d("bench depth", gl::Format::depth32f, camera.width, camera.height)),
        framebuffer("bench", {&color}, &depth) {}

  gl::Texture color, depth;
  gl::Framebuffer framebuffer;
  Target target() const { return {color, depth, framebuffer}; }
};

/// Draws the subjects in turn in blocks of BenchResult::kBlockFrames, at least `frames` of each, and between one
/// subject and the next once a block has `reference`, if any, trace a picture. Returns the subjects' times [ms].
std::vector<std::vector<double>> time_in_turn(std::span<const FrameClock::Draw> subjects, int frames, FrameClock& clock,
                                              ReferenceTracer* reference);

/// Times the method, the bare shader and what both share, and with `reference` the reference, and fills in the times
/// and ratios.
void time_subjects(const std::array<FrameClock::Draw, 3>& subjects, int frames, ReferenceTracer* reference,
                   BenchResult& result);

/// Throws InputError for fewer frames than have an interval.
void check_frames(const BenchRequest&);

/// The scene with the request's settings, a frame of it drawn, and the recipe of what was drawn. The session checks
/// names and values; those of the technique go to `parameters` too. Throws InputError for a setting that is
/// neither the technique's nor `scene.…` nor `frame.format`, since the bench's frames are not the session's.
RenderSession bench_session(const BenchRequest&, const char* technique, ParameterRef parameters,
                            nlohmann::json& recipe);

}  // namespace pellucid::sweeps
