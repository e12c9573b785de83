// Comparing: what with, how, and the layers of errors; live figures.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "plots/pictures/false_color.hpp"
#include "sandbox/viewer/app/app.hpp"
#include "sweeps/metrics/flip.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace pellucid::sandbox {
namespace {

constexpr const char* kNothing = "(nothing)";
constexpr const char* kReference = "reference";
constexpr const char* kPicture = "picture";
constexpr const char* kFlip = "FLIP against the second";
const std::vector<std::string> kModes{"A alone", "B alone", "side by side", "wipe", "blink", "difference"};

}  // namespace

void App::journal_second() {
  if (journal_.on() && second_.image())
    journal_.write({{"event", "second"}, {"width", second_.image()->width}, {"words", second_.words()}});
}

void App::choose_against(const std::string& what) {
  if (what == kNothing || what.empty()) {
    second_.choose(Against::nothing);
    panel_.set_side(Side::a);
    display_.mode = CompareMode::a;
    blink_ = false;
    if (layer_kind_ == Layer::flip) choose_layer(kPicture);
  } else if (what == kReference) {
    second_.choose(Against::reference);
  } else if (what.ends_with(".exr") || what.ends_with(".png")) {
    second_.choose(Against::file, what);
    journal_second();
  } else {
    workspace_.set_technique(Side::b, std::string(find_technique(what).name));
    second_.choose(Against::technique);
  }
  if (second_.against() != Against::nothing && display_.mode == CompareMode::a && !blink_)
    display_.mode = CompareMode::wipe;
  layer_changed_ = panel_dirty_ = picture_dirty_ = true;
}

std::size_t App::compare_mode() const {
  return blink_ ? 4 : display_.mode == CompareMode::difference ? 5 : static_cast<std::size_t>(display_.mode);
}

const std::string& App::compare_mode_name() const {
  return kModes[compare_mode()];
}

void App::set_mode(std::size_t mode) {
  if (second_.against() == Against::nothing) return say("compare with something first", true);
  blink_ = mode == 4;
  display_.mode = mode == 4 ? CompareMode::a : mode == 5 ? CompareMode::difference : static_cast<CompareMode>(mode);
  panel_dirty_ = picture_dirty_ = true;
  say(kModes[mode]);
}

void App::next_mode() {
  set_mode((compare_mode() + 1) % kModes.size());
}

DisplaySettings App::effective_display() const {
  DisplaySettings out = display_;
  if (!second_.image()) out.mode = CompareMode::a;
  if (second_.image() && blink_) out.mode = std::fmod(glfwGetTime(), 1.0) < 0.5 ? CompareMode::a : CompareMode::b;
  if (layer_shown_) {
    out.mode = CompareMode::a;
    out.encoded = true;
    out.false_color = out.warn = false;
    out.channel = -1;
  }
  return out;
}

std::vector<std::string> App::layers() const {
  std::vector<std::string> out{kPicture};
  if (second_.against() != Against::nothing) out.emplace_back(kFlip);
  if (find_technique(workspace_.technique(Side::a)).maps) {
    if (shown_[0] && !shown_[0]->maps.empty()) {
      for (const NativeMap& map : shown_[0]->maps)
        out.push_back(map.name);
    } else {
      out.emplace_back("the technique's own errors");
    }
  }
  return out;
}

void App::choose_layer(const std::string& name) {
  layer_kind_ = name == kPicture ? Layer::picture : name == kFlip ? Layer::flip : Layer::native;
  native_map_ = layer_kind_ == Layer::native ? name : "";
  workspace_.want_maps(layer_kind_ == Layer::native);
  layer_choice_->current = name;
  layer_changed_ = panel_dirty_ = true;
}

void App::upload_pictures() {
  picture_dirty_ = panel_dirty_ = true;
  if (!shown_[0]) return;
  layer_shown_ = layer_kind_ != Layer::picture;
  const std::shared_ptr<const Image> a(shown_[0], &shown_[0]->image);
  const auto& b = second_.image();
  if (b) pictures_.set_b(*b);
  if (layer_kind_ == Layer::flip && b) {
    const bool sized = a->width == b->width && a->height == b->height;
    if (sized && (flip_asked_a_ != a || flip_asked_b_ != b)) {
      flip_asked_a_ = a;
      flip_asked_b_ = b;
      flip_.ask(a, b);
    }
    if (flip_result_ && flip_result_->trouble.empty() && flip_result_->test == a) {
      scale_words_ = fmt::format("FLIP, mean {:.4g}", flip_result_->flip_mean);
      scale_end_ = 1;
      return pictures_.set_a(sweeps::error_colors(flip_result_->map));
    }
    scale_words_ = sized ? "FLIP is being computed" : "the second picture has another size";
    return pictures_.set_a(Image(a->width, a->height, 3));
  }
  if (layer_kind_ == Layer::native) {
    const auto& maps = shown_[0]->maps;
    auto it = std::find_if(maps.begin(), maps.end(), [&](const NativeMap& map) { return map.name == native_map_; });
    if (it == maps.end()) it = maps.begin();
    if (it != maps.end()) {
      native_map_ = it->name;
      scale_end_ = plots::color_range({&it->values});
      scale_words_ = it->unit.empty() ? it->name : fmt::format("{} [{}]", it->name, it->unit);
      return pictures_.set_a(plots::false_colors(it->values, scale_end_));
    }
    scale_words_ = "no map yet";
    layer_shown_ = false;
  }
  pictures_.set_a(*a);
}

double App::frames_per_s() const {
  // Over the last second, so that it stands still long enough to be read.
  if (times_.size() < 2) return 0;
  std::size_t first = times_.size() - 1;
  while (first > 0 && times_.back().shown_s - times_[first - 1].shown_s < 1)
    --first;
  const double span = times_.back().shown_s - times_[first].shown_s;
  return span > 0 ? static_cast<double>(times_.size() - 1 - first) / span : 0;
}

PanelPart App::compare_part() {
  PanelPart part;
  part.build = [this](Stack& content) {
    auto* section = new Section(&content, "Compare", second_.against() != Against::nothing);
    auto* against_bar = new Bar(section->body(), "With");
    against_choice_ = new Choice(against_bar);
    against_choice_->setId("compare with");
    against_choice_->set_hint(
        "The second picture: another technique on the same scene and view, or the ground truth, traced in the "
        "background and shown as it converges.");
    against_choice_->items = {kNothing, kReference};
    for (const TechniqueInfo& info : techniques())
      against_choice_->items.emplace_back(info.name);
    against_choice_->chosen = [this](const std::string& item) { guarded([&] { choose_against(item); }); };
    auto* file_bar = new Bar(section->body(), "or a file");
    against_field_ = new Field(file_bar);
    against_field_->setId("compare file");
    against_field_->set_hint("An EXR or PNG; it is read again when it changes.");
    against_field_->offer = [this](const std::string& path) -> std::string {
      if (path.empty()) return "";
      try {
        choose_against(path);
      } catch (const std::exception& e) {
        say(e.what(), true);
        return e.what();
      }
      return "";
    };
    auto* mode_bar = new Bar(section->body(), "Shown");
    mode_choice_ = new Choice(mode_bar);
    mode_choice_->setId("compare mode");
    mode_choice_->items = kModes;
    mode_choice_->set_hint("How the two are shown (M). The line of a wipe is dragged.");
    mode_choice_->chosen = [this](const std::string& item) {
      set_mode(static_cast<std::size_t>(std::find(kModes.begin(), kModes.end(), item) - kModes.begin()));
    };
    auto* gain_bar = new Bar(section->body(), "Gain");
    gain_slider_ = new SliderBar(gain_bar);
    gain_slider_->setId("gain");
    gain_slider_->set_hint("The factor of a difference: 1 to 1024.");
    gain_slider_->dragged = [this](double share) {
      display_.gain = std::exp2(static_cast<float>(std::round(share * 10)));
      picture_dirty_ = true;
    };
    gain_slider_->nudge = [this](double steps) {
      display_.gain = std::clamp(display_.gain * std::exp2(static_cast<float>(steps)), 1.0F, 1024.0F);
      picture_dirty_ = true;
    };
    auto* layer_bar = new Bar(section->body(), "Layer");
    layer_choice_ = new Choice(layer_bar);
    layer_choice_->setId("layer");
    layer_choice_->set_hint(
        "The picture, its FLIP error against the second, or what the technique tells of its errors.");
    layer_choice_->chosen = [this](const std::string& item) { guarded([&] { choose_layer(item); }); };
    auto* side_bar = new Bar(section->body());
    side_button_ = new PushButton(side_bar, "Change B", [this] { act(GLFW_KEY_B, 0); });
    side_button_->setId("change b");
    side_button_->set_hint("Whose parameters the panel shows (B).");
    compare_note_ = new Note(section->body());
  };
  part.refresh = [this] {
    against_choice_->current = second_.against() == Against::nothing     ? kNothing
                               : second_.against() == Against::reference ? kReference
                               : second_.against() == Against::technique ? workspace_.technique(Side::b)
                                                                         : second_.file().filename().string();
    mode_choice_->current = kModes[compare_mode()];
    gain_slider_->set_share(std::log2(display_.gain) / 10);
    layer_choice_->items = layers();
    layer_choice_->current = layer_kind_ == Layer::picture ? kPicture
                             : layer_kind_ == Layer::flip  ? kFlip
                                                           : native_map_;
    side_button_->set_words(panel_.side() == Side::a ? "Change B" : "Change A");
    std::string words = second_.words();
    if (flip_result_ && flip_result_->trouble.empty() && shown_[0] && flip_result_->test.get() == &shown_[0]->image)
      words += fmt::format("\nFLIP {:.4g}, RMSE {:.4g}, PSNR {:.4g} dB", flip_result_->flip_mean, flip_result_->rmse,
                           flip_result_->psnr);
    if (words != compare_note_->words) {
      compare_note_->words = words;
      desk_->layout_changed();
    }
  };
  return part;
}

PanelPart App::live_part() {
  PanelPart part;
  part.build = [this](Stack& content) {
    auto* section = new Section(&content, "Live figures and sweeps", false);
    auto* bar = new Bar(section->body());
    const auto button = [](Bar* parent, const char* words, const char* hint, std::function<void()> pushed) {
      auto* out = new PushButton(parent, words, std::move(pushed));
      out->setId(words);
      out->set_hint(hint);
    };
    button(bar, "Graph", "The times of the passes, frame by frame (G).", [this] { act(GLFW_KEY_G, 0); });
    button(bar, "Time frames", "Draws frame after frame (Shift+G).", [this] { act(GLFW_KEY_G, GLFW_MOD_SHIFT); });
    auto* sweeps = new Bar(section->body());
    button(sweeps, "Sweep here",
           "Runs the range of the parameter that was last in focus, at this view, in processes of its own (X).",
           [this] { sweep_here(); });
    button(sweeps, "Add as an axis", "Adds that parameter to the spec of this folder (Shift+X).",
           [this] { add_axis(); });
  };
  return part;
}

}  // namespace pellucid::sandbox
