// The window measures itself: `pellucid view … --measure`.
#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "gl/error.hpp"
#include "gl/resources/resources.hpp"
#include "sandbox/status.hpp"
#include "sandbox/viewer/app/app.hpp"
#include "sweeps/measure/stopping.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace pellucid::sandbox {
namespace {

constexpr double kPatience_s = 60;
constexpr int kFrames = 30, kTyped = 20, kSaved = 8;
constexpr double kIdle_s = 5;

// The bounds that the window keeps to, on llvmpipe at 720x540 too. Nothing can be typed and seen sooner than a frame is
// drawn: where frames are slow the bound of a typed value is two of them and what the window adds.
constexpr double kWindowsShare_ms = 20;
constexpr double kFrameRatio = 1.05, kTyped_ms = 100, kSaved_ms = 200, kIdlePercent = 2;

double now_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Processor seconds of a process so far.
double processor_s(int pid) {
  std::ifstream file(fmt::format("/proc/{}/stat", pid));
  std::string text;
  std::getline(file, text);
  // The name in brackets may hold spaces; the times are the 12th and 13th fields behind it.
  const std::size_t end = text.rfind(')');
  if (end == std::string::npos) return 0;
  std::istringstream fields(text.substr(end + 1));
  std::string word;
  double ticks = 0;
  for (int i = 1; i <= 13 && fields >> word; ++i)
    if (i >= 12) ticks += std::stod(word);
  return ticks / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

}  // namespace

bool App::shows_the_picture() const {
  return !workspace_.stale(Side::a) && shown_[0] == workspace_.picture(Side::a) && !picture_dirty_;
}

bool App::shows_the_state() const {
  return shows_the_picture() && !panel_dirty_;
}

double App::until(const char* what, const std::function<bool()>& reached) {
  const double began = now_ms();
  while (!reached()) {
    if (!turn(0.05)) throw RuntimeError(kept_.trouble);
    if (!workspace_.trouble().empty()) throw InputError(workspace_.trouble());
    if (now_ms() - began > kPatience_s * 1000) throw RuntimeError(fmt::format("{} never came", what));
  }
  glFinish();
  return now_ms() - began;
}

// Alternately with and without the window's part, so that both see the same load of the machine.
std::pair<double, double> App::measure_frames() {
  std::vector<double> shown, alone;
  for (int i = 0; i < kFrames; ++i) {
    until("a frame", [this] { return shows_the_state(); });
    workspace_.ask();
    until("a frame", [this] { return shows_the_state(); });
    shown.push_back(shown_[0]->frame_ms);
    workspace_.ask();
    while (workspace_.stale(Side::a)) {
      gl::Window::wait_events(0.05);
      workspace_.poll();
      if (!workspace_.trouble().empty()) throw RuntimeError(workspace_.trouble());
    }
    alone.push_back(workspace_.picture(Side::a)->frame_ms);
  }
  return {sweeps::median_of(shown), sweeps::median_of(alone)};
}

// From Enter to the finished drawing of the frame, through the same functions as a hand's keys.
std::vector<double> App::measure_typing() {
  const auto groups = workspace_.groups(Side::a);
  std::string name;
  std::vector<std::string> texts;
  for (const ParameterInfo& info : groups.front().infos) {
    if (info.type != ValueType::real && info.type != ValueType::integer) continue;
    if (!name.empty() && info.when != Change::uniform) continue;
    const double standard = info.type == ValueType::real
                                ? std::get<double>(info.default_value)
                                : static_cast<double>(std::get<std::int64_t>(info.default_value));
    const double other = standard + 1 <= info.max ? standard + 1 : (standard + info.min) / 2;
    name = info.name;
    texts = {info.type == ValueType::real ? fmt::format("{}", other) : fmt::format("{:.0f}", std::floor(other)),
             to_text(info.default_value)};
    if (info.when == Change::uniform) break;
  }
  std::vector<double> out;
  for (int i = 0; i < kTyped && !name.empty(); ++i) {
    desk_->focus_on(name + " field");
    panel_dirty_ = true;
    until("the focus", [this] { return shows_the_state(); });
    for (const char c : texts[static_cast<std::size_t>(i % 2)])
      desk_->character(static_cast<unsigned char>(c));
    panel_dirty_ = true;
    until("the typed text", [this] { return shows_the_state(); });
    const double began = now_ms();
    desk_->key_pressed(GLFW_KEY_ENTER, 0, GLFW_PRESS, 0);
    panel_dirty_ = true;
    until("the typed value", [this] { return shows_the_picture(); });
    out.push_back(now_ms() - began);
  }
  return out;
}

// From the end of writing the file to the finished drawing of a frame by the new program.
std::vector<double> App::measure_saving() {
  std::vector<double> out;
  const std::string prefix = "algorithms/" + workspace_.technique(Side::a) + "/";
  const std::vector<std::string> shaders = list_resources(prefix, ".frag.glsl");
  if (shaders.empty()) return out;
  const std::filesystem::path path = options_.shaders / shaders.front();
  const std::string text = find_resource(shaders.front()).value_or(""), head = "void main() {";
  assert(text.find(head) != std::string::npos && "a shader without a main function");
  const std::size_t body = text.find(head) + head.size();
  for (int i = 0; i < kSaved; ++i) {
    until("the picture", [this] { return shows_the_state(); });
    const auto before = shown_[0];
    // Other code each time, in this run and the next: drivers keep what they made of code that they know.
    std::string changed = text;
    changed.insert(body, fmt::format("\n  if (gl_FragCoord.x == -{}.{}) discard;", ::getpid(), i));
    std::ofstream(path) << changed;
    const double began = now_ms();
    until("the saved shader", [&] { return shown_[0] != before && shows_the_picture(); });
    out.push_back(now_ms() - began);
  }
  return out;
}

double App::measure_idling() {
  desk_->let_go();
  until("rest", [this] { return shows_the_state() && said_.empty(); });
  const auto used = [this] {
    double all = processor_s(::getpid());
    for (const int pid : workspace_.pids())
      all += processor_s(pid);
    return all;
  };
  const double before = used(), began = now_ms();
  for (double left = kIdle_s; left > 0; left = kIdle_s - (now_ms() - began) / 1000)
    turn(std::min(left, next_wake_s().value_or(left)));
  return 100 * (used() - before) / ((now_ms() - began) / 1000);
}

int App::measure() {
  until("the first picture", [this] { return shows_the_state(); });
  const auto [shown_ms, alone_ms] = measure_frames();
  const std::vector<double> typed = measure_typing(), saved = measure_saving();
  const double idle = measure_idling();
  nlohmann::ordered_json figures{
      {"frame_ms_window", shown_ms}, {"frame_ms_headless", alone_ms}, {"frame_ratio", shown_ms / alone_ms}};
  if (!typed.empty()) {
    figures["typed_ms_median"] = sweeps::median_of(typed);
    figures["typed_ms_max"] = *std::max_element(typed.begin(), typed.end());
  }
  if (!saved.empty()) {
    figures["saved_ms_median"] = sweeps::median_of(saved);
    figures["saved_ms_max"] = *std::max_element(saved.begin(), saved.end());
  }
  figures["idle_percent"] = idle;
  const double typed_bound_ms = std::max(kTyped_ms, 2 * alone_ms + kWindowsShare_ms);
  const bool good = shown_ms / alone_ms <= kFrameRatio && figures.value("typed_ms_median", 0.0) <= typed_bound_ms &&
                    figures.value("saved_ms_median", 0.0) <= kSaved_ms && idle <= kIdlePercent;
  if (options_.json) {
    fmt::print("{}\n", figures.dump(2));
  } else {
    fmt::print("a frame: {:.2f} ms with the window, {:.2f} ms without: {:.3f} times (at most {})\n", shown_ms, alone_ms,
               shown_ms / alone_ms, kFrameRatio);
    if (!typed.empty()) {
      const double ms = figures["typed_ms_median"];
      fmt::print("a typed value is drawn after {:.1f} ms, the slowest after {:.1f} ms (at most {})\n", ms,
                 figures["typed_ms_max"].get<double>(), kTyped_ms);
      if (ms > kTyped_ms && ms <= typed_bound_ms)
        fmt::print("  {} ms are missed by the frame's own cost of {:.1f} ms; the rest takes {:.1f} ms\n", kTyped_ms,
                   alone_ms, ms - alone_ms);
    }
    if (!saved.empty())
      fmt::print(
          "a saved shader is drawn after {:.1f} ms, the slowest after {:.1f} ms (at most {}); the frame is {:.1f} "
          "ms of it\n",
          figures["saved_ms_median"].get<double>(), figures["saved_ms_max"].get<double>(), kSaved_ms, alone_ms);
    fmt::print("idle: {:.2f} % of a core (at most {})\n", idle, kIdlePercent);
  }
  return good ? 0 : kRegression;
}

}  // namespace pellucid::sandbox
