#include "sandbox/viewer/app/tweaking.hpp"

#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

namespace pellucid::sandbox {
namespace {

namespace fs = std::filesystem;

// Some states take minutes to prepare; a hand would not wait for them either. The state before, to which cancelling
// goes back, may take as long where others use the machine: each time that it is cancelled too the patience doubles.
constexpr double kLongest_s = 15;

// Turns of the loop after the first picture: what the window makes once is there by then.
constexpr int kFirstTurns = 10;

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::size_t entries(const fs::path& folder) {
  std::error_code gone;
  std::size_t count = 0;
  for (fs::directory_iterator it(folder, gone), end; !gone && it != end; it.increment(gone))
    ++count;
  return count;
}

std::size_t children() {
  std::size_t count = 0;
  std::error_code gone;
  for (fs::directory_iterator it("/proc/self/task", gone), end; !gone && it != end; it.increment(gone)) {
    std::ifstream file(it->path() / "children");
    for (int pid = 0; file >> pid;)
      ++count;
  }
  return count;
}

// NaN is the same as NaN here.
bool same_pixels(const Image& a, const Image& b) {
  return a.width == b.width && a.height == b.height && a.channels == b.channels &&
         std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(float)) == 0;
}

}  // namespace

Tweaking::Tweaking(std::uint64_t seed, double seconds) : tweaks_(seed), seconds_(seconds) {}

Tweaking::Counts Tweaking::counts(const Workspace& workspace) {
  Counts out;
  out.objects = gl::count_live_objects();
  out.files = entries("/proc/self/fd");
  out.children = children();
  for (const int pid : workspace.pids())
    out.renderer_files += entries(fmt::format("/proc/{}/fd", pid));
  return out;
}

void Tweaking::fault(const std::string& words) {
  ++faults_[words];
}

void Tweaking::check(const Workspace& workspace) {
  if (const std::string words = RandomTweaks::disagreement(workspace); !words.empty())
    fault("the picture is of another state than the panel's: " + words);
  if (workspace.failures() != failures_) {
    failures_ = workspace.failures();
    const ViewState state = workspace.state(Side::a);
    fault(fmt::format("{} with {}: {}", state.scene, state.technique, workspace.last_failure()));
  }
  for (const Side side : {Side::a, Side::b}) {
    const auto& picture = workspace.picture(side);
    if (picture && !picture->objects_left.empty())
      fault(fmt::format("{} were left behind by the session before {} with {}", picture->objects_left,
                        picture->state.scene, picture->state.technique));
  }
}

void Tweaking::look_back(const Workspace& workspace) {
  const Picture& fresh = *workspace.picture(Side::a);
  last_ = counts(workspace);
  if (!same_pixels(old_->image, fresh.image)) {
    fault(fmt::format("a renderer that has just started draws another picture of {} with {}", fresh.state.scene,
                      fresh.state.technique));
  }
  if (const std::string kept = gl::growth(fresh.objects, old_->objects); !kept.empty())
    fault("the renderer's context holds more than that of one that has just started: " + kept);
  if (const std::string more = gl::growth(first_.objects, last_.objects); !more.empty())
    fault("the window's context holds more than at the start: " + more);
  const auto same = [&](std::size_t before, std::size_t after, const char* what) {
    if (before != after) fault(fmt::format("{}: {} at the start, {} at the end", what, before, after));
  };
  same(first_.files, last_.files, "files open in the window");
  same(first_.children, last_.children, "processes");
}

bool Tweaking::turn(Workspace& workspace) {
  check(workspace);
  const double now = now_s();
  const bool settled = !workspace.busy() && workspace.picture(Side::a) && !workspace.stale(Side::a);
  switch (phase_) {
    case Phase::opening:
      if (!settled) return true;
      if (++opened_ < kFirstTurns) return true;
      first_ = counts(workspace);
      began_s_ = asked_s_ = now;
      phase_ = Phase::running;
      return true;
    case Phase::running: {
      if (workspace.busy()) {
        if (now - asked_s_ > kLongest_s * std::exp2(in_a_row_)) {
          workspace.cancel();
          ++cancelled_;
          ++in_a_row_;
          asked_s_ = now;
        }
        return true;
      }
      in_a_row_ = 0;
      if (!workspace.trouble(Side::b).empty() && compare) compare("");
      if (!workspace.trouble(Side::a).empty() && workspace.picture(Side::a)) {
        workspace.cancel();  // a refused state: back to the last one that was drawn
        asked_s_ = now;
        return true;
      }
      if (now - began_s_ < seconds_) {
        const std::string other = tweaks_.comparison();
        if (!other.empty() && compare) compare(other == RandomTweaks::kNothing ? "" : other);
        tweaks_.step(workspace);
        asked_s_ = now;
        return true;
      }
      if (compare) compare("");
      phase_ = Phase::settling;
      return true;
    }
    case Phase::settling:
      if (!settled) return true;
      old_ = workspace.picture(Side::a);
      last_ = counts(workspace);
      workspace.renew();
      phase_ = Phase::renewed;
      return true;
    case Phase::renewed: {
      if (!settled) return true;
      const std::size_t old_files = last_.renderer_files;
      look_back(workspace);
      if (old_files > last_.renderer_files + 1)  // the driver's cache of shaders opens one now and then
        fault(fmt::format("files open in the renderer: {}, in one that has just started {}", old_files,
                          last_.renderer_files));
      phase_ = Phase::over;
      return false;
    }
    case Phase::over:
      return false;
  }
  return false;
}

nlohmann::json Tweaking::report(const Workspace& workspace) const {
  nlohmann::json faults = nlohmann::json::array();
  for (const auto& [words, times] : faults_)
    faults.push_back({{"fault", words}, {"times", times}});
  return {{"event", "tweaks"},
          {"complete", phase_ == Phase::over},
          {"steps", tweaks_.steps()},
          {"pictures", workspace.pictures_seen()},
          {"cancelled", cancelled_},
          {"parameters", tweaks_.parameters_seen()},
          {"techniques", tweaks_.techniques_seen()},
          {"scenes", tweaks_.scenes_seen()},
          {"window_objects", {gl::total(first_.objects), gl::total(last_.objects)}},
          {"files", {first_.files, last_.files}},
          {"processes", {first_.children, last_.children}},
          {"faults", faults}};
}

}  // namespace pellucid::sandbox
