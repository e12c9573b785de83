#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "sandbox/viewer/app/app.hpp"
#include "sandbox/viewer/app/save.hpp"
#include "sweeps/spec/provenance.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace pellucid::sandbox {

void App::make_actions() {
  const auto add = [this](int key, int modifiers, const char* keys, const char* meaning, std::function<void()> run) {
    actions_.push_back({key, modifiers, keys, meaning, std::move(run)});
  };
  const int ctrl = GLFW_MOD_CONTROL, shift = GLFW_MOD_SHIFT;
  const auto expose = [this](float by) {
    display_.exposure_ev = by == 0 ? 0 : display_.exposure_ev + by;
    say(fmt::format("exposure {:+.1f} EV", display_.exposure_ev));
  };
  const auto channel = [this](int which) {
    display_.channel = display_.channel == which ? -1 : which;
    const char* names[] = {"all channels", "red alone", "green alone", "blue alone", "alpha alone"};
    say(names[display_.channel + 1]);
  };
  add(GLFW_KEY_F1, 0, "?  F1", "this page", [this] { desk_->toggle_keys(); });
  add(GLFW_KEY_F, ctrl, "/  Ctrl+F", "search the parameters", [this] { panel_.focus_search(); });
  add(GLFW_KEY_P, 0, "P", "hide or show the panel", [this] { desk_->show_panel(desk_->panel_width() == 0); });
  add(GLFW_KEY_T, 0, "T", "next technique", [this] { panel_.step_technique(1); });
  add(GLFW_KEY_T, shift, "Shift+T", "previous technique", [this] { panel_.step_technique(-1); });
  add(GLFW_KEY_V, 0, "V", "next view", [this] { panel_.step_view(1); });
  add(GLFW_KEY_V, shift, "Shift+V", "previous view", [this] { panel_.step_view(-1); });
  add(GLFW_KEY_HOME, 0, "Home", "back to the scene's first view", [this] { workspace_.set_view(""); });
  add(GLFW_KEY_R, shift, "Shift+R", "every parameter back to its default", [this] { panel_.reset_all(); });
  add(GLFW_KEY_F5, 0, "F5", "draw again, with another renderer where one has failed", [this] {
    second_.again();
    workspace_.ask();
  });
  add(GLFW_KEY_SPACE, 0, "Space", "play or pause scene.time_s", [this] {
    playing_ = !playing_;
    played_s_ = glfwGetTime();
  });
  const auto step = [this](double by) {
    playing_ = false;
    guarded([&] {
      const ParameterInfo* time = workspace_.info(Side::a, "scene.time_s");
      if (time == nullptr) return say("this scene has no scene.time_s to step", true);
      const double now = std::get<double>(workspace_.get(Side::a, "scene.time_s"));
      workspace_.set(Side::a, "scene.time_s", std::clamp(std::round((now + by) * 1000) / 1000, time->min, time->max));
    });
  };
  add(GLFW_KEY_PERIOD, 0, ".", "one frame (1/30 s) on", [step] { step(1.0 / 30); });
  add(GLFW_KEY_COMMA, 0, ",", "one frame back", [step] { step(-1.0 / 30); });
  add(GLFW_KEY_RIGHT_BRACKET, 0, "]", "half a stop brighter", [expose] { expose(0.5F); });
  add(GLFW_KEY_LEFT_BRACKET, 0, "[", "half a stop darker", [expose] { expose(-0.5F); });
  add(GLFW_KEY_0, 0, "0", "exposure back to 0", [expose] { expose(0); });
  add(GLFW_KEY_1, 0, "1  2  3  4", "red, green, blue or alpha alone", [channel] { channel(0); });
  add(GLFW_KEY_2, 0, "", "", [channel] { channel(1); });
  add(GLFW_KEY_3, 0, "", "", [channel] { channel(2); });
  add(GLFW_KEY_4, 0, "", "", [channel] { channel(3); });
  add(GLFW_KEY_F, 0, "F", "false colours of the luminance", [this] { display_.false_color = !display_.false_color; });
  add(GLFW_KEY_N, 0, "N", "mark NaN, infinite and negative pixels", [this] { display_.warn = !display_.warn; });
  add(GLFW_KEY_EQUAL, 0, "=  -", "zoom the picture in or out",
      [this] { zoom_.about(static_cast<float>(region().width) / 2, static_cast<float>(region().height) / 2, 2); });
  add(GLFW_KEY_MINUS, 0, "", "",
      [this] { zoom_.about(static_cast<float>(region().width) / 2, static_cast<float>(region().height) / 2, 0.5F); });
  add(GLFW_KEY_Z, 0, "Z", "the whole picture", [this] { zoom_.fitted = true; });
  add(GLFW_KEY_S, ctrl, "Ctrl+S", "save an EXR that says how it was made", [this] { save(".exr"); });
  add(GLFW_KEY_S, ctrl | shift, "Ctrl+Shift+S", "save a PNG as displayed", [this] { save(".png"); });
  add(GLFW_KEY_S, ctrl | GLFW_MOD_ALT, "Ctrl+Alt+S", "save the chosen region, or what is seen, as EXR",
      [this] { save_crop(); });
  add(GLFW_KEY_C, 0, "C", "copy as a command line", [this] { copy_command(); });
  add(GLFW_KEY_M, 0, "M", "next way to compare: side by side, wipe, blink …", [this] { next_mode(); });
  add(GLFW_KEY_B, 0, "B", "the panel changes the other side", [this] {
    if (second_.against() != Against::technique) return say("compare with a technique first", true);
    panel_.set_side(panel_.side() == Side::a ? Side::b : Side::a);
    say(panel_.side() == Side::a ? "the panel changes A" : "the panel changes B");
  });
  add(GLFW_KEY_L, 0, "L", "next layer: the picture, FLIP, the technique's own errors", [this] {
    const std::vector<std::string> all = layers();
    const auto it = std::find(all.begin(), all.end(), layer_choice_->current);
    choose_layer(it == all.end() || it + 1 == all.end() ? all.front() : *(it + 1));
  });
  add(GLFW_KEY_G, 0, "G", "graph of frame times", [this] { graph_ = !graph_; });
  add(GLFW_KEY_G, shift, "Shift+G", "draw frame after frame, to time them", [this] {
    measuring_ = !measuring_;
    graph_ = graph_ || measuring_;
  });
  add(GLFW_KEY_X, 0, "X", "sweep the parameter at the pointer or the focus, here", [this] { sweep_here(); });
  add(GLFW_KEY_X, shift, "Shift+X", "add that parameter to a spec as an axis", [this] { add_axis(); });
  add(GLFW_KEY_DELETE, 0, "Del", "close the sweep, the region", [this] {
    if (sweep_) {
      sweep_.reset();
    } else {
      box_ = {};
    }
  });
  add(GLFW_KEY_K, 0, "K", "keep this set-up as a bookmark", [this] { keep_bookmark(); });
  add(GLFW_KEY_Y, 0, "Y", "this camera is the next stop of a way for frames", [this] { add_stop(); });
  add(GLFW_KEY_Y, shift, "Shift+Y", "forget that way", [this] {
    kept_.way.clear();
    say("numbered frames: the camera stays where it is");
  });
  add(GLFW_KEY_F, ctrl | shift, "Ctrl+Shift+F", "render numbered frames", [this] { render_frames(); });
  add(GLFW_KEY_C, ctrl, "Ctrl+C", "copy the picture as PNG", [this] { copy_picture(".png"); });
  add(GLFW_KEY_C, ctrl | shift, "Ctrl+Shift+C", "copy it as EXR, with all that made it",
      [this] { copy_picture(".exr"); });
  add(GLFW_KEY_Q, ctrl, "Ctrl+Q", "close", [this] { glfwSetWindowShouldClose(window_.handle(), GLFW_TRUE); });

  for (const Action& action : actions_)
    if (!action.keys.empty()) desk_->keys.emplace_back(action.keys, action.meaning);
  for (const auto& [keys, meaning] : std::vector<std::pair<std::string, std::string>>{
           {"Tab  Shift+Tab", "the next or previous control"},
           {"arrows, Enter", "change it; digits type a value"},
           {"Esc", "leave the control; cancel what runs"},
           {"W A S D  E Q", "fly; with Shift faster"},
           {"arrows", "look around, without a control"},
           {"drag", "orbit"},
           {"Shift+drag, middle", "pan"},
           {"right drag, wheel", "dolly"},
           {"Alt+drag", "move the light or object of the last scene parameter"},
           {"Ctrl+drag", "choose a region for figures and a histogram"},
           {"Ctrl+wheel", "zoom the picture at the pointer"},
           {"Ctrl+right drag", "move the zoomed picture"}}) {
    desk_->keys.emplace_back(keys, meaning);
  }
  desk_->symbol = [this](unsigned codepoint) {
    if (codepoint == '?') desk_->toggle_keys();
    if (codepoint == '/') panel_.focus_search();
    panel_dirty_ = true;
    return codepoint == '?' || codepoint == '/';
  };
}

bool App::act(int key, int modifiers) {
  const int relevant = modifiers & (GLFW_MOD_CONTROL | GLFW_MOD_SHIFT | GLFW_MOD_ALT);
  for (const Action& action : actions_) {
    if (action.key != key || action.modifiers != relevant) continue;
    guarded(action.run);
    panel_dirty_ = picture_dirty_ = true;
    return true;
  }
  return false;
}

void App::save(const std::string& extension) {
  if (!shown_[0]) return say("there is no picture to save yet", true);
  const std::string scene = std::filesystem::path(shown_[0]->state.scene).stem().string();
  const auto path = free_name(options_.folder, scene + "_" + shown_[0]->state.technique, extension);
  save_picture(*shown_[0], path, {options_.display, options_.display_view, display_.exposure_ev, options_.look});
  journal_.write({{"event", "saved"}, {"path", path.string()}});
  say(fmt::format("saved {}", path.string()));
}

void App::save_crop() {
  if (!shown_[0]) return say("there is no picture to save yet", true);
  PixelBox box = box_;
  if (box.empty()) {
    const Region at = region();
    box.x0 = static_cast<int>(std::floor(zoom_.left));
    box.y0 = static_cast<int>(std::floor(zoom_.top));
    box.x1 = static_cast<int>(std::ceil(zoom_.left + static_cast<float>(at.width) / zoom_.scale));
    box.y1 = static_cast<int>(std::ceil(zoom_.top + static_cast<float>(at.height) / zoom_.scale));
  }
  const std::string scene = std::filesystem::path(shown_[0]->state.scene).stem().string();
  const auto path = free_name(options_.folder, scene + "_" + shown_[0]->state.technique + "_crop", ".exr");
  write_picture(path, crop_of(*shown_[0], box.x0, box.y0, box.x1, box.y1), {});
  journal_.write({{"event", "saved"}, {"path", path.string()}});
  say(fmt::format("saved {}", path.string()));
}

void App::copy(const std::string& text, const std::string& what) {
  glfwSetClipboardString(window_.handle(), text.c_str());
  journal_.write({{"event", "copied"}, {"text", text}});
  say(fmt::format("copied {}", what));
}

void App::copy_command() {
  copy(sweeps::shell_line(render_words(workspace_.state(panel_.side()), "picture.exr")), "the command line");
}

}  // namespace pellucid::sandbox
