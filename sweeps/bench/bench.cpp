#include "sweeps/bench/bench.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/bare_frame.hpp"
#include "algorithms/parameter_names.hpp"
#include "algorithms/render_session.hpp"
#include "algorithms/technique.hpp"
#include "gl/error.hpp"
#include "sweeps/bench/bench_reference.hpp"
#include "sweeps/measure/frame_clock.hpp"

namespace pellucid::sweeps {
namespace {

constexpr double kWarmUpSeconds = 10;

double block_median(const std::vector<double>& samples, std::size_t first, std::size_t count) {
  std::vector<double> block(samples.begin() + static_cast<std::ptrdiff_t>(first),
                            samples.begin() + static_cast<std::ptrdiff_t>(first + count));
  std::sort(block.begin(), block.end());
  return quantile(block, 0.5);
}

/// Draws the subjects in turn in blocks of BenchResult::kBlockFrames, at least `frames` of each, and between one
/// subject and the next once a block has `reference`, if any, trace a picture. Returns the subjects' times [ms].
std::vector<std::vector<double>> time_in_turn(std::span<const FrameClock::Draw> subjects, int frames, FrameClock& clock,
                                              ReferenceTracer* reference) {
  std::vector<std::vector<double>> samples(subjects.size());
  for (const FrameClock::Draw& subject : subjects) {
    WarmUp warm_up(kWarmUpFrames, kWarmUpSeconds / static_cast<double>(subjects.size()));
    std::vector<double> times;
    while (!warm_up.done()) {
      clock.draw(subject, &times);
      clock.drain();
      warm_up.add(times.back());
    }
  }
  if (reference != nullptr) {
    reference->trace();
    reference->forget();
  }
  const int blocks = (frames + BenchResult::kBlockFrames - 1) / BenchResult::kBlockFrames;
  for (int block = 0; block < blocks; ++block) {
    for (std::size_t i = 0; i < subjects.size(); ++i) {
      clock.draw(subjects[i], nullptr);  // the first finds the other's textures in the caches
      for (int frame = 0; frame < BenchResult::kBlockFrames; ++frame)
        clock.draw(subjects[i], &samples[i]);
      if (i > 0 || reference == nullptr) continue;
      clock.drain();
      reference->trace();
    }
  }
  clock.drain();
  return samples;
}

/// Times the method, the bare shader and what both share, and with `reference` the reference, and fills in the times
/// and ratios.
void time_subjects(BareFrame& frame, int frames, ReferenceTracer* reference, BenchResult& result) {
  using Part = BareFrame::Part;
  const std::array<FrameClock::Draw, 3> subjects{[&](gl::PassTimer& timer) { frame.render(timer, Part::method); },
                                                 [&](gl::PassTimer& timer) { frame.render(timer, Part::bare); },
                                                 [&](gl::PassTimer& timer) { frame.render(timer, Part::shared); }};
  FrameClock clock;
  const std::vector<std::vector<double>> samples = time_in_turn(subjects, frames, clock, reference);
  result.frames = static_cast<int>(samples[0].size());
  result.clock = gl::name(clock.clock());
  result.method = summarise(samples[0]);
  result.bare = summarise(samples[1]);
  result.opaque = summarise(samples[2]);
  const auto ratio = block_ratio(samples[0], samples[1], {}, BenchResult::kBlockFrames);
  assert(ratio);  // every time is positive
  result.ratio = *ratio;
  result.own = block_ratio(samples[0], samples[1], samples[2], BenchResult::kBlockFrames);
  if (reference != nullptr) result.reference = reference->against(samples[0], BenchResult::kBlockFrames);
}

}  // namespace

std::optional<BenchRatio> block_ratio(const std::vector<double>& a, const std::vector<double>& b,
                                      const std::vector<double>& c, int block) {
  assert(block > 0 && a.size() == b.size() && (c.empty() || c.size() == a.size()));
  const auto count = static_cast<std::size_t>(block);
  std::vector<double> ratios;
  for (std::size_t first = 0; first + count <= a.size(); first += count) {
    const double shared = c.empty() ? 0 : block_median(c, first, count);
    const double over = block_median(a, first, count) - shared;
    const double under = block_median(b, first, count) - shared;
    // A block whose noise hides the denominator counts as the greatest; ranks stay defined, and none is left out.
    ratios.push_back(under > 0 ? over / under : std::numeric_limits<double>::infinity());
  }
  if (ratios.empty()) return std::nullopt;
  std::sort(ratios.begin(), ratios.end());
  const Interval ci95 = bootstrap_median_interval(ratios);
  if (!std::isfinite(ci95.high)) return std::nullopt;
  return BenchRatio{quantile(ratios, 0.5), ci95};
}

BenchResult bench(const TechniqueInfo& technique, const BenchRequest& request, nlohmann::json& recipe) {
  const BareFrameInfo& bare = bare_frame_of(technique);
  if (request.frames < 2 * BenchResult::kBlockFrames) {
    throw InputError(fmt::format("bench: frames = {} is below {}, the least that has an interval", request.frames,
                                 2 * BenchResult::kBlockFrames));
  }
  const std::string scene = request.scene.empty() ? bare.scene : request.scene;
  RenderSession session(load_scene(scene), technique.name, request.view, request.width, request.height);
  ShadowSettings shadow;
  std::vector<std::pair<std::string, std::string>> own;
  for (const auto& [name, value] : request.settings) {
    session.assign_text(name, value);
    const ParameterName routed = route(name);
    if (routed.owner == ParameterOwner::shadow) {
      const ParameterRef table = bind_parameters(shadow);
      table.assign(routed.local, parse_value(*table.table->find(routed.local), value, "shadow"), "shadow");
    } else if (routed.owner == ParameterOwner::technique) {
      own.emplace_back(name, value);
    } else if (routed.owner == ParameterOwner::frame && routed.local != "format") {
      throw InputError(fmt::format("bench: {} of {} is timed with the default of '{}'", technique.name, scene, name));
    }
  }
  session.prepare();
  gl::PassTimer untimed;
  session.render(untimed);
  recipe = {{"technique", technique.name},
            {"scene", scene},
            {"view", session.camera().view.name},
            {"width", request.width},
            {"height", request.height},
            {"parameters", session.parameters()},
            {"scene_hash", session.scene().content_hash()}};

  const auto frame = bare.make({.scene = session.scene(),
                                .camera = session.camera(),
                                .format = session.color().format(),
                                .shadow = shadow,
                                .settings = own,
                                .session_frame = [&](gl::PassTimer& timer) { session.render(timer); }});
  BenchResult result;
  const BareFrame::Counts counts = frame->counts();
  result.blends_per_pixel = counts.blends_per_pixel;
  result.fetches_per_blend = counts.fetches_per_blend;
  result.fetches_per_pixel = counts.blends_per_pixel * counts.fetches_per_blend;
  std::optional<ReferenceTracer> reference;
  if (const auto options = frame->reference(); options && request.reference) {
    reference.emplace(session.scene(), session.camera(), *options);
  }
  time_subjects(*frame, request.frames, reference ? &*reference : nullptr, result);
  return result;
}

const BareFrameInfo& bare_frame_of(const TechniqueInfo& technique) {
  std::vector<std::string_view> names;
  for (const BareFrameInfo* info : bare_frames()) {
    if (info->technique == technique.name) return *info;
    names.push_back(info->technique);
  }
  throw InputError(
      fmt::format("bench: there is no bare shader of {}, only of {}", technique.name, fmt::join(names, ", ")));
}

}  // namespace pellucid::sweeps
