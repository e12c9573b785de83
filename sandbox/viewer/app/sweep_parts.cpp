// Sweeps from the window, specs and bookmarks.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "algorithms/scene/files/atomic_file.hpp"
#include "gl/error.hpp"
#include "sandbox/viewer/app/app.hpp"
#include "sandbox/viewer/app/save.hpp"
#include "sandbox/viewer/out/clipboard.hpp"

namespace pellucid::sandbox {
namespace {

constexpr float kThumbnail = 92, kMargin = 8;

/// For NanoVG: 8 bits, display-encoded already.
int nanovg_image(NVGcontext* ctx, const Image& image) {
  std::vector<unsigned char> bytes;
  bytes.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 4);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float* p = image.at(x, y);
      for (int c = 0; c < 3; ++c)
        bytes.push_back(
            static_cast<unsigned char>(std::lround(255 * std::clamp(p[image.channels < 3 ? 0 : c], 0.0F, 1.0F))));
      bytes.push_back(255);
    }
  }
  return nvgCreateImageRGBA(ctx, image.width, image.height, 0, bytes.data());
}

void draw_image(NVGcontext* ctx, int image, float x, float y, float w, float h) {
  nvgBeginPath(ctx);
  nvgRect(ctx, x, y, w, h);
  nvgFillPaint(ctx, nvgImagePattern(ctx, x, y, w, h, 0, image, 1));
  nvgFill(ctx);
}

}  // namespace

void App::sweep_here() {
  const std::string name = panel_.current_parameter().empty() ? panel_.last_parameter() : panel_.current_parameter();
  if (name.empty()) return say("put the pointer or the focus on a parameter first", true);
  const ParameterInfo* info = workspace_.info(panel_.side(), name);
  if (info == nullptr) return;
  for (int& image : thumbnail_images_)
    if (image != 0) nvgDeleteImage(desk_->nvgContext(), std::exchange(image, 0));
  sweep_.reset();
  sweep_ = std::make_unique<SweepHere>(workspace_.state(panel_.side()), name, *info, options_.folder, options_.device,
                                       [] { gl::Window::wake(); });
  thumbnail_images_.assign(sweep_->values().size(), 0);
  chart_stale_ = true;
  journal_.write({{"event", "sweep"}, {"spec", sweep_->spec().string()}, {"store", sweep_->store().string()}});
  say(fmt::format("sweeping {} into {}", name, sweep_->store().string()));
}

void App::follow_sweep() {
  if (!sweep_ || !sweep_->poll()) return;
  chart_stale_ = panel_dirty_ = true;
  journal_.write({{"event", "sweep rows"}, {"rows", sweep_->rows().size()}, {"running", sweep_->running()}});
  if (!sweep_->running() && !sweep_->trouble().empty()) say(sweep_->trouble(), true);
}

void App::paint_sweep(NVGcontext* ctx, float x, float y, float w, float h) {
  if (std::exchange(chart_stale_, false)) {
    guarded([&] {
      if (const auto image = sweep_->chart()) {
        if (chart_image_ != 0) nvgDeleteImage(ctx, chart_image_);
        chart_image_ = nanovg_image(ctx, *image);
        chart_width_ = image->width;
        chart_height_ = image->height;
      }
    });
    for (std::size_t i = 0; i < thumbnail_images_.size(); ++i) {
      if (thumbnail_images_[i] != 0 || !sweep_->thumbnails()[i]) continue;
      Image small = sweep_->thumbnails()[i]->image;
      pictures_.transform().apply(small.pixels, small.channels);
      thumbnail_images_[i] = nanovg_image(ctx, small);
    }
  }
  const auto& values = sweep_->values();
  const float ratio = static_cast<float>(workspace_.height()) / static_cast<float>(workspace_.width());
  const float room = (w - 2 * kMargin) / static_cast<float>(values.size());
  const float thumb_w = std::min(kThumbnail, room - 4), thumb_h = thumb_w * ratio;
  const float strip = y + h - thumb_h - 26 - kMargin;
  chart_place_ = {x + kMargin, strip, room, thumb_h + 24};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float left = x + kMargin + static_cast<float>(i) * room;
    paint::box(ctx, left, strip, thumb_w + 4, thumb_h + 24, nvgRGBA(18, 19, 21, 230));
    if (thumbnail_images_[i] != 0) draw_image(ctx, thumbnail_images_[i], left + 2, strip + 2, thumb_w, thumb_h);
    const bool now = to_text(workspace_.get(panel_.side(), sweep_->parameter())) == to_text(values[i]);
    if (now) paint::outline(ctx, left, strip, thumb_w + 4, thumb_h + 24, paint::accent());
    paint::line(ctx, left + 2, strip + thumb_h + 2, thumb_w, 20, to_text(values[i]), paint::text(), paint::kSmallText,
                paint::Align::center);
  }
  const float line = strip - 26;
  if (chart_image_ != 0 && chart_width_ > 0) {
    const float height =
        std::min({360.0F, line - y - 2 * kMargin,
                  (w - 2 * kMargin) * static_cast<float>(chart_height_) / static_cast<float>(chart_width_)});
    const float width = height * static_cast<float>(chart_width_) / static_cast<float>(chart_height_);
    draw_image(ctx, chart_image_, x + w - width - kMargin, line - height - kMargin, width, height);
  }
  const std::string words =
      fmt::format("{} of {} points {}   Del closes; the store {} stays", sweep_->rows().size(), values.size(),
                  sweep_->running() ? "…" : "done", sweep_->store().filename().string());
  paint::box(ctx, x + kMargin, line, std::min(w - 16, 520.0F), 20, nvgRGBA(18, 19, 21, 230));
  paint::line(ctx, x + kMargin + 6, line, std::min(w - 28, 508.0F), 20, words, paint::text(), paint::kSmallText);
}

bool App::sweep_clicked(double x, double y) {
  const auto [left, top, step, height] = chart_place_;
  const double at = (x - left) / step;
  if (y < top || y > top + height || at < 0 || at >= static_cast<double>(sweep_->values().size())) return false;
  workspace_.set(panel_.side(), sweep_->parameter(), sweep_->values()[static_cast<std::size_t>(at)]);
  return true;
}

void App::add_axis() {
  const std::string name = panel_.current_parameter().empty() ? panel_.last_parameter() : panel_.current_parameter();
  if (name.empty()) return say("put the pointer or the focus on a parameter first", true);
  const ParameterInfo* info = workspace_.info(panel_.side(), name);
  const ViewState state = workspace_.state(panel_.side());
  const std::filesystem::path path = options_.folder / (state.technique + "_spec.toml");
  std::string list;
  for (const Value& value : sweep_values(*info, 9))
    list += (list.empty() ? "" : ", ") + toml_value(value);
  const std::string line = fmt::format("{} = [{}]", name, list);
  std::string text;
  if (std::ifstream in(path); in) text.assign(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  if (text.empty()) {
    text = sweep_spec(state, name, sweep_values(*info, 9), state.technique + "_spec");
  } else {
    const std::string head = "[run.axes]\n";
    const std::size_t at = text.find(head);
    if (at == std::string::npos) throw InputError(fmt::format("{} has no [run.axes] to add to", path.string()));
    if (text.find("\n" + name + " = ") != std::string::npos) {
      // A parameter that was fixed until now is varied; an axis stays as somebody may have edited it.
      const std::size_t fixed = text.find("[run.fixed]"), there = text.find("\n" + name + " = ");
      if (fixed == std::string::npos || there < fixed)
        return say(fmt::format("{} has {} already", path.string(), name), true);
      text.erase(there, text.find('\n', there + 1) - there);
    }
    text.insert(text.find(head) + head.size(), line + "\n");
  }
  write_text_file(path, text);
  journal_.write({{"event", "axis"}, {"path", path.string()}, {"line", line}});
  say(fmt::format("{}: {}", path.string(), line));
}

void App::go_to_bookmark(const std::string& name) {
  const ViewState* state = bookmarks_.find(name);
  if (state == nullptr) return;
  workspace_.set_state(*state);
  bookmark_named_ = name;
}

void App::keep_bookmark() {
  const bool named = !bookmark_named_.empty();
  const std::string base = named ? bookmark_named_
                                 : fmt::format("{} {}", std::filesystem::path(workspace_.scene()).stem().string(),
                                               workspace_.technique(Side::a));
  // One that is kept already is never replaced.
  std::string name = named ? base : base + " 1";
  for (int number = 2; bookmarks_.find(name) != nullptr; ++number)
    name = fmt::format("{} {}", base, number);
  bookmarks_.put(name, workspace_.state(Side::a));
  journal_.write({{"event", "bookmark"}, {"name", name}});
  say(fmt::format("kept as '{}'; it is in the section Out", name));
}

void App::remove_bookmark() {
  const std::string name = bookmark_named_;
  if (bookmarks_.find(name) == nullptr)
    return say(name.empty() ? "choose a bookmark first" : fmt::format("no bookmark is called '{}'", name), true);
  bookmarks_.remove(name);
  bookmark_named_.clear();
  journal_.write({{"event", "bookmark removed"}, {"name", name}});
  say(fmt::format("removed '{}'", name));
}

void App::copy_picture(const std::string& extension) {
  if (!shown_[0]) return say("there is no picture to copy yet", true);
  const auto path =
      std::filesystem::temp_directory_path() / fmt::format("pellucid_clipboard_{}{}", ::getpid(), extension);
  std::string trouble;
  try {
    save_picture(*shown_[0], path, {options_.display, options_.display_view, display_.exposure_ev, options_.look});
    copy_file_to_clipboard(path, extension == ".exr" ? "image/x-exr" : "image/png");
  } catch (const RuntimeError& e) {
    trouble = e.what();
  }
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
  if (!trouble.empty()) throw RuntimeError(trouble);
  journal_.write({{"event", "copied"}, {"text", extension}});
  say(fmt::format("copied the picture as {}", extension == ".exr" ? "EXR" : "PNG"));
}

}  // namespace pellucid::sandbox
