// The parts of the panel below the parameters.
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "sandbox/viewer/app/app.hpp"
#include "sandbox/viewer/panel/controls.hpp"

namespace pellucid::sandbox {
namespace {

PushButton* button(nanogui::Widget* parent, const std::string& words, const std::string& hint,
                   std::function<void()> pushed) {
  auto* out = new PushButton(parent, words, std::move(pushed));
  out->setId(words);
  out->set_hint(hint);
  return out;
}

}  // namespace

PanelPart App::display_part() {
  PanelPart part;
  part.build = [this](Stack& content) {
    auto* section = new Section(&content, "Display", false);
    auto* view_bar = new Bar(section->body(), "Transform");
    auto* view = new Choice(view_bar);
    view->setId("display transform");
    view->set_hint("OpenColorIO's display and view, of $OCIO or the embedded config.");
    for (const auto& [display, name] : pictures_.transform().views())
      view->items.push_back(display + ": " + name);
    view->current = pictures_.transform().display() + ": " + pictures_.transform().view();
    view->chosen = [this, view](const std::string& item) {
      guarded([&] {
        for (const auto& [display, name] : pictures_.transform().views()) {
          if (item != display + ": " + name) continue;
          pictures_.set_transform(display, name, options_.look);
          options_.display = display;
          options_.display_view = name;
          view->current = item;
          picture_dirty_ = true;
          break;
        }
      });
    };
    auto* look_bar = new Bar(section->body(), "Look");
    auto* look = new Choice(look_bar);
    look->setId("look");
    look->set_hint("OpenColorIO's looks; the embedded config has none.");
    look->items = pictures_.transform().looks();
    look->items.insert(look->items.begin(), "(none)");
    look->current = options_.look.empty() ? "(none)" : options_.look;
    look->chosen = [this, look](const std::string& item) {
      guarded([&] {
        const std::string name = item == "(none)" ? "" : item;
        pictures_.set_transform(options_.display, options_.display_view, name);
        options_.look = name;
        look->current = item;
        picture_dirty_ = true;
      });
    };
    auto* exposure_bar = new Bar(section->body(), "Exposure");
    auto* exposure = new SliderBar(exposure_bar);
    exposure->setId("exposure");
    exposure->set_hint("Stops by which the picture is brightened, -8 to 8; keys [ ] and 0.");
    exposure->dragged = [this](double share) {
      display_.exposure_ev = static_cast<float>(std::round((share * 16 - 8) * 10) / 10);
      picture_dirty_ = true;
    };
    exposure->nudge = [this](double steps) {
      display_.exposure_ev = static_cast<float>(std::clamp(display_.exposure_ev + steps * 0.1, -8.0, 8.0));
      picture_dirty_ = true;
    };
    exposure->set_share((display_.exposure_ev + 8) / 16);
    auto* marks = new Bar(section->body());
    button(marks, "False colour", "Luminance from 2^-6 to 2^6 around the exposure in colours (F).", [this] {
      display_.false_color = !display_.false_color;
      picture_dirty_ = true;
    });
    button(marks, "Warnings", "NaN magenta, infinite cyan, negative blue (N).", [this] {
      display_.warn = !display_.warn;
      picture_dirty_ = true;
    });
    exposure_ = exposure;
  };
  part.refresh = [this] {
    if (exposure_ != nullptr) exposure_->set_share((display_.exposure_ev + 8) / 16);
  };
  return part;
}

PanelPart App::out_part() {
  PanelPart part;
  part.build = [this](Stack& content) {
    auto* section = new Section(&content, "Out", false);
    auto* files = new Bar(section->body());
    button(files, "Save EXR", "Scene-linear, with all that made it; pellucid view opens it again (Ctrl+S).",
           [this] { guarded([&] { save(".exr"); }); });
    button(files, "Save PNG", "As displayed (Ctrl+Shift+S).", [this] { guarded([&] { save(".png"); }); });
    auto* clip = new Bar(section->body());
    button(clip, "Copy picture", "As PNG (Ctrl+C), with Ctrl+Shift+C as EXR; needs xclip.",
           [this] { guarded([&] { copy_picture(".png"); }); });
    button(clip, "Copy command", "The command line that renders this picture (C).", [this] { copy_command(); });
    auto* marks = new Bar(section->body(), "Bookmark");
    auto* bookmark = new Choice(marks);
    bookmark->setId("bookmark");
    bookmark->set_hint("Set-ups that were kept; they survive the program.");
    bookmark->chosen = [this](const std::string& name) { guarded([&] { go_to_bookmark(name); }); };
    bookmark_choice_ = bookmark;
    bookmark_name_ = new Field(new Bar(section->body(), "Name"));
    bookmark_name_->setId("bookmark name");
    bookmark_name_->set_hint(
        "The bookmark to keep or to remove. Without a name it is called after its scene and technique.");
    bookmark_name_->offer = [this](const std::string& name) {
      bookmark_named_ = name;
      return std::string();
    };
    auto* keep = new Bar(section->body());
    button(keep, "Keep this", "Keeps scene, technique, view and all parameters as a bookmark (K).",
           [this] { guarded([&] { keep_bookmark(); }); });
    button(keep, "Remove", "Removes the bookmark of that name.", [this] { guarded([&] { remove_bookmark(); }); });
  };
  part.refresh = [this] {
    bookmark_choice_->items.clear();
    for (const Bookmark& kept : bookmarks_.all())
      bookmark_choice_->items.push_back(kept.name);
    bookmark_choice_->current = bookmarks_.all().empty()                      ? "(none is kept)"
                                : bookmarks_.find(bookmark_named_) != nullptr ? bookmark_named_
                                                                              : "(choose)";
    bookmark_name_->show(bookmark_named_);
  };
  return part;
}

}  // namespace pellucid::sandbox
