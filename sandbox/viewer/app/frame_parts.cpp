// Numbered frames of a range of times and a way of the camera.
#include <charconv>
#include <functional>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "algorithms/scene/files/tell.hpp"
#include "gl/error.hpp"
#include "sandbox/viewer/app/app.hpp"
#include "sandbox/viewer/camera/frame_range.hpp"
#include "sweeps/spec/provenance.hpp"

namespace pellucid::sandbox {
namespace {

// The range of `pellucid render --fps`.
constexpr double kLeastFps = 0.001, kMostFps = 100000;

double parse_fps(const std::string& text) {
  double fps = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), fps);
  if (error != std::errc{} || end != text.data() + text.size() || !(fps >= kLeastFps && fps <= kMostFps))
    throw InputError(fmt::format("'{}' is no number in [{:g}, {:g}]", text, kLeastFps, kMostFps));
  return fps;
}

/// The reason why `parse` refuses the text, or nothing.
template <class Parse>
std::string refusal(Parse parse, const std::string& text) {
  try {
    parse(text);
    return "";
  } catch (const InputError& e) {
    return e.what();
  }
}

}  // namespace

PanelPart App::frames_part() {
  PanelPart part;
  part.build = [this](Stack& content) {
    auto* section = new Section(&content, "Numbered frames", false);
    const auto field = [&](const char* label, const char* id, const char* hint, std::string& kept, auto parse) {
      auto* out = new Field(new Bar(section->body(), label));
      out->setId(id);
      out->set_hint(hint);
      out->offer = [this, &kept, parse](const std::string& text) {
        std::string reason = refusal(parse, text);
        if (reason.empty()) {
          kept = text;
        } else {
          say(reason, true);
        }
        return reason;
      };
      return out;
    };
    frames_field_ = field("Frames", "frames",
                          "FIRST:LAST, both drawn: scene.time_s is the frame's number over the "
                          "frames per second.",
                          kept_.frames_text, parse_frames);
    fps_field_ = field("Per second", "fps", "Frames per second of scene.time_s.", kept_.fps_text, parse_fps);
    const auto button = [](Bar* bar, const char* words, const char* hint, std::function<void()> pushed) {
      auto* out = new PushButton(bar, words, std::move(pushed));
      out->setId(words);
      out->set_hint(hint);
    };
    auto* way = new Bar(section->body());
    button(way, "Add this camera", "The next stop of the camera's way over the frames (Y).",
           [this] { act(GLFW_KEY_Y, 0); });
    button(way, "Forget the way", "The camera stays where it is (Shift+Y).",
           [this] { act(GLFW_KEY_Y, GLFW_MOD_SHIFT); });
    auto* run = new Bar(section->body());
    button(run, "Render frames",
           "EXR files in a folder of their own, by a process of its own (Ctrl+Shift+F); Esc stops it.",
           [this] { act(GLFW_KEY_F, GLFW_MOD_CONTROL | GLFW_MOD_SHIFT); });
    frames_note_ = new Note(section->body());
  };
  part.refresh = [this] {
    frames_field_->show(kept_.frames_text);
    fps_field_->show(kept_.fps_text);
    std::string words = kept_.way.empty() ? "The camera stays where it is."
                                          : fmt::format("The camera's way has {}.", counted(kept_.way.size(), "stop"));
    for (const Field* field : {frames_field_, fps_field_})
      if (!field->reason().empty()) words += "\n" + field->reason();
    if (words == frames_note_->words) return;
    frames_note_->words = words;
    desk_->layout_changed();
  };
  return part;
}

void App::add_stop() {
  const std::string& named = workspace_.view_name();
  if (named.empty() && workspace_.views().empty()) return say("the scene's views are not known yet", true);
  kept_.way.push_back(named.empty() ? workspace_.views().front().name : named);
  say(fmt::format("the camera's way for numbered frames has {}", counted(kept_.way.size(), "stop")));
}

void App::render_frames() {
  if (kept_.frames) return say("numbered frames are being rendered already; Esc stops that", true);
  kept_.frames = std::make_unique<FrameSeries>(workspace_.state(Side::a), kept_.way, parse_frames(kept_.frames_text),
                                               parse_fps(kept_.fps_text), options_.folder, options_.device);
  journal_.write({{"event", "frames"},
                  {"folder", kept_.frames->folder().string()},
                  {"command", sweeps::shell_line(kept_.frames->command())}});
  say(fmt::format("rendering {} frames into {}", kept_.frames->count(), kept_.frames->folder().string()));
}

std::string App::frames_words() const {
  return fmt::format("{} of {} frames are in {}{}", kept_.frames->done(), kept_.frames->count(),
                     kept_.frames->folder().string(), kept_.frames->running() ? " … (Esc stops)" : "");
}

bool App::stop_frames() {
  if (!kept_.frames) return false;
  kept_.frames->stop();
  say("stopped; " + frames_words());
  kept_.frames.reset();
  return true;
}

void App::follow_frames() {
  if (!kept_.frames || !kept_.frames->poll()) return;
  const FrameSeries& frames = *kept_.frames;
  journal_.write({{"event", "frames done"}, {"done", frames.done()}, {"running", frames.running()}});
  panel_dirty_ = true;
  if (frames.running()) return;
  if (frames.trouble().empty()) {
    say(frames_words());
  } else {
    say(frames.trouble(), true);
  }
  kept_.frames.reset();
}

}  // namespace pellucid::sandbox
