#include "sweeps/measure/measure.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "algorithms/scene/images/finite.hpp"
#include "algorithms/scene/images/picture_file.hpp"
#include "algorithms/scene/view_text.hpp"
#include "gl/context.hpp"
#include "gl/display/display.hpp"
#include "gl/error.hpp"
#include "gl/timer.hpp"
#include "sweeps/measure/errors_by_class.hpp"
#include "sweeps/measure/frame_clock.hpp"
#include "sweeps/measure/stopping.hpp"
#include "sweeps/spec/clock.hpp"
#include "sweeps/spec/point_json.hpp"
#include "sweeps/spec/provenance.hpp"

namespace pellucid::sweeps {
namespace {

constexpr double kWarmUpShare = 0.25;  ///< of max_seconds
constexpr int kPassFrames = 5;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Resets the kernel's high-water mark of the resident set. Where it refuses, the mark stands since the process began.
void reset_peak_rss() {
  std::ofstream("/proc/self/clear_refs") << "5";
}

std::size_t peak_rss_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmHWM:")) return std::stoull(line.substr(6)) * 1024;
  }
  struct rusage usage {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

void keep_picture(const std::filesystem::path& path, Image color, const Point& point) {
  std::error_code error;
  std::filesystem::create_directories(path.parent_path(), error);
  if (error) {
    throw RuntimeError(fmt::format("folder '{}' cannot be made: {}", path.parent_path().string(), error.message()));
  }
  const Attributes attributes{{"pellucid.point", point.id}, {"pellucid.repeat", repeat_command(point)}};
  if (path.extension() == ".exr") {
    ImageFile file;
    file.image = std::move(color);
    file.attributes = attributes;
    write_exr(path, file);
    return;
  }
  for (int y = 0; color.channels == 4 && y < color.height; ++y) {
    for (int x = 0; x < color.width; ++x)
      color.at(x, y)[3] = 1;  // a picture to look at, not to composite
  }
  gl::DisplayTransform().apply(color.pixels, color.channels);
  write_png(path, color, attributes);
}

}  // namespace

void Measurer::open_session(const Point& point) {
  const std::string key = fmt::format("{}\n{}", point.scene, point.technique);
  if (!session_ || session_key_ != key) {
    session_.reset();  // before the next is made: their memory must not add up
    session_.emplace(load_scene(point.scene), point.technique, point.view, point.size.width, point.size.height);
    session_key_ = key;
    prepare_s_ = 0;
    assigned_.clear();
  }
  // Only what differs: an assignment may cost a program or a precomputation. The session rounds reals to float, so what
  // was assigned is remembered.
  const nlohmann::json current = session_->parameters();
  for (const auto& [name, value] : point.parameters) {
    const auto before = assigned_.find(name);
    const bool same = before != assigned_.end() ? before->second == value
                                                : current.contains(name) && current.at(name) == value_to_json(value);
    if (!same) session_->assign(name, value);
    assigned_[name] = value;
  }
  const Camera& camera = session_->camera();
  if (camera.width != point.size.width || camera.height != point.size.height) {
    session_->resize(point.size.width, point.size.height);
  }
  session_->set_view(view_of(session_->scene(), point.view));
  if (const double seconds = session_->prepare(); seconds > 0) prepare_s_ = seconds;
}

void Measurer::time_frames(const Point& point, Measurement& result) {
  FrameClock clock(gl::Detail::frame);
  const FrameClock::Draw frame = [&](gl::PassTimer& timer) { session_->render(timer); };
  std::size_t warmup_frames = 0;
  const auto warm_up = [&] {
    WarmUp warming(kWarmUpFrames, kWarmUpShare * point.timing.max_seconds);
    while (!warming.done())
      warming.add(clock.next(frame).frame_ms);
    warmup_frames += warming.frames();
  };
  warm_up();

  StoppingRule rule(point.timing);
  result.row["timed_unix_s"] = unix_now_s();
  SleepWatch sleep;
  double slept_s = 0;
  const auto start = std::chrono::steady_clock::now();
  while (rule.verdict() == Verdict::more) {
    const double frame_ms = clock.next(frame).frame_ms;
    if (const double s = sleep.slept_s(); s > 0) {
      // Neither this frame nor those under way tell a frame's time, and the machine is cold again.
      slept_s += s;
      clock.drain();
      warm_up();
      continue;
    }
    if (!std::isfinite(frame_ms) || frame_ms < 0)
      throw RuntimeError(fmt::format("the clock gave {} ms for a frame", frame_ms));
    rule.add(frame_ms, seconds_since(start));
  }
  clock.drain();

  const TimingSummary summary = summarise(rule.samples_ms());
  nlohmann::json& row = result.row;
  row["frame_ms_median"] = summary.median_ms;
  row["frame_ms_ci95_low"] = summary.ci95_ms.low;
  row["frame_ms_ci95_high"] = summary.ci95_ms.high;
  row["frame_ms_mean"] = summary.mean_ms;
  row["frame_ms_q25"] = summary.q25_ms;
  row["frame_ms_q75"] = summary.q75_ms;
  if (summary.median_ms > 0) row["fps"] = 1000 / summary.median_ms;
  row["frames"] = rule.samples_ms().size();
  row["warmup_frames"] = warmup_frames;
  if (slept_s > 0) row["slept_s"] = slept_s;
  row["timing"] = rule.verdict() == Verdict::converged ? "converged" : "unconverged";
  row["clock"] = gl::name(clock.clock());
  result.frame_ms_samples = rule.samples_ms();
}

void Measurer::time_passes(Measurement& result) {
  FrameClock clock(gl::Detail::passes);
  const FrameClock::Draw frame = [&](gl::PassTimer& timer) { session_->render(timer); };
  std::map<std::string, std::vector<double>> samples;
  for (int i = 0; i < kPassFrames; ++i) {
    for (const auto& [name, ms] : clock.next(frame).pass_ms)
      samples[name].push_back(ms);
  }
  clock.drain();
  nlohmann::json passes = nlohmann::json::object();
  for (auto& [name, values] : samples) {
    std::sort(values.begin(), values.end());
    passes[name] = quantile(values, 0.5);
  }
  result.row["pass_ms"] = std::move(passes);
}

std::shared_ptr<const CachedReference> Measurer::reference(const Point& point,
                                                           const std::filesystem::path& references) {
  if (!references_ || references_->folder() != references) references_ = std::make_unique<ReferenceCache>(references);
  return references_->get(*session_, point, [&](double share) { progress_("reference", share); });
}

void Measurer::compare(const Point& point, const Image& color, const std::filesystem::path& references,
                       Measurement& result) {
  if (session_->parameters().value("frame.format", "") == "half")
    result.row["saturated_pixels"] = saturated_pixels(color);
  session_->technique().native_errors(result.row);
  if (point.metrics.empty()) return;
  const auto reference = this->reference(point, references);
  progress_("metrics", 0);
  const ComparisonResult compared = reference->comparison.compare(color);
  put_values(result.row, compared);
  if (session_->technique_info().classes && compared.flip_map.width > 0) {
    for (const NativeMap& map : session_->technique().native_maps())
      put_errors_by_class(result.row, map, compared.flip_map);
  }
  result.row["reference_step_error_max"] = reference->step_error_max;
  result.row["reference_step_error_mean"] = reference->step_error_mean;
  result.row["reference_unconverged_share"] = reference->unconverged_share;
  result.row["reference_method"] = name(point.reference.method);
  if (reference->traced) {
    const SurfaceStatistics& traced = *reference->traced;
    result.row["reference_samples"] = traced.samples;
    result.row["reference_standard_error_max"] = traced.standard_error_max;
    result.row["reference_standard_error_mean"] = traced.standard_error_mean;
    result.row["reference_caustic_error_max"] = traced.caustic_standard_error_max;
    result.row["reference_caustic_error_mean"] = traced.caustic_standard_error_mean;
    result.row["reference_cut_weight_max"] = traced.cut_weight_max;
    result.row["reference_cut_weight_mean"] = traced.cut_weight_mean;
    result.row["reference_lost_weight_mean"] = traced.lost_weight_mean;
    result.row["reference_trace_s"] = traced.trace_s;
  }
  if (reference->shadow_pixels_share) result.row["shadow_pixels_share"] = *reference->shadow_pixels_share;
  if (reference->to_exact) {
    result.row["reference_to_exact_rmse"] = reference->to_exact->at("rmse");
    result.row["reference_to_exact_flip_mean"] = reference->to_exact->at("flip_mean");
  }
}

Measurement Measurer::measure(const Point& point, const std::filesystem::path& references,
                              const std::filesystem::path& picture) {
  try {
    Measurement result;
    progress_("prepare", 0);
    quiet_.wait_to_work();
    reset_peak_rss();
    open_session(point);
    gl::PassTimer untimed;
    session_->render(untimed);
    if (point.timing.enabled) {
      progress_("timing", 0);
      quiet_.wait_to_time();
      time_frames(point, result);
      time_passes(result);
      quiet_.wait_to_work();
    } else {
      result.row["timing"] = "off";
    }
    result.row["prepare_s"] = prepare_s_;
    result.row["gpu_bytes"] = gl::allocated_bytes();
    result.row["peak_rss_bytes"] = peak_rss_bytes();
    result.row["scene_hash"] = session_->scene().content_hash();
    const Image color = session_->read_color();
    require_finite(color, "the frame");
    if (!picture.empty()) keep_picture(picture, color, point);
    compare(point, color, references, result);
    const nlohmann::json parameters = session_->parameters();
    for (const auto& [name, value] : parameters.items()) {
      assert(!result.row.contains(name) && "a parameter has the name of a result");
      result.row[name] = value;
    }
    quiet_.release();
    return result;
  } catch (...) {
    quiet_.release();
    session_.reset();
    throw;
  }
}

Measurement Measurer::time(const Point& point) {
  try {
    Measurement result;
    quiet_.wait_to_work();
    open_session(point);
    quiet_.wait_to_time();
    time_frames(point, result);
    quiet_.release();
    return result;
  } catch (...) {
    quiet_.release();
    session_.reset();
    throw;
  }
}

void Measurer::trace(const Point& point, const std::filesystem::path& references) {
  try {
    open_session(point);
    gl::PassTimer untimed;
    session_->render(untimed);  // what is drawn of a reference is drawn as for a frame
    reference(point, references);
  } catch (...) {
    session_.reset();
    throw;
  }
}

}  // namespace pellucid::sweeps
