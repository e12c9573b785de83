// This file paints over the picture: names of the sides, the chosen region's figures, frame times, errors of shaders.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "sandbox/viewer/app/app.hpp"
#include "sweeps/metrics/flip.hpp"

namespace pellucid::sandbox {
namespace {

NVGcolor ground() {
  return nvgRGBA(18, 19, 21, 225);
}

NVGcolor pass_color(std::size_t i) {
  // Okabe and Ito's colours, told apart by people who see few.
  constexpr unsigned char colors[][3] = {{86, 180, 233},  {230, 159, 0}, {0, 158, 115}, {240, 228, 66},
                                         {204, 121, 167}, {213, 94, 0},  {0, 114, 178}};
  const auto& c = colors[i % std::size(colors)];
  return nvgRGB(c[0], c[1], c[2]);
}

void label(NVGcontext* ctx, float x, float y, const std::string& words, bool right = false) {
  nvgFontFace(ctx, "sans");
  nvgFontSize(ctx, paint::kText);
  const float width = nvgTextBounds(ctx, 0, 0, words.c_str(), nullptr, nullptr) + 12;
  const float left = right ? x - width : x;
  paint::box(ctx, left, y, width, 20, ground());
  paint::line(ctx, left + 6, y, width, 20, words, paint::text());
}

}  // namespace

void App::paint_over(NVGcontext* ctx, float x, float y, float w, float h) {
  const float scale = desk_->ui_scale();
  const DisplaySettings settings = effective_display();
  if (second_.image()) {
    const std::string a = workspace_.technique(Side::a), b = second_.words();
    if (settings.mode == CompareMode::side_by_side) {
      label(ctx, x + 6, y + 6, a);
      label(ctx, x + w / 2 + 6, y + 6, b);
    } else if (settings.mode == CompareMode::wipe) {
      const float at = x + settings.wipe * w;
      paint::box(ctx, at - 1, y, 2, h, paint::accent(), 0);
      label(ctx, at - 6, y + 6, a, true);
      label(ctx, at + 6, y + 6, b);
    } else if (settings.mode == CompareMode::difference) {
      label(ctx, x + 6, y + 6, fmt::format("|{} − {}| × {:g}", a, b, settings.gain));
    } else {
      label(ctx, x + 6, y + 6, settings.mode == CompareMode::b ? b : a);
    }
  }
  if (layer_kind_ != Layer::picture) paint_scale(ctx, x, y, w, h);
  if (!box_.empty()) paint_box(ctx, x, y, w, scale);
  if (graph_) paint_times(ctx, x + 8, y + h - 128, std::min(w - 16, 420.0F), 120);
  const std::string words = workspace_.shader_error().empty()
                                ? workspace_.trouble()
                                : "The last good shaders go on.\n" + workspace_.shader_error();
  if (!words.empty()) {
    const float width = std::min(w - 16, 720.0F);
    const float height = paint::paragraph(ctx, 0, 0, width - 16, words, paint::text(), paint::kText, false);
    paint::box(ctx, x + 8, y + 8, width, height + 16, ground());
    paint::paragraph(ctx, x + 16, y + 16, width - 16, words, paint::warning(), paint::kText, true);
  }
  if (sweep_) paint_sweep(ctx, x, y, w, h);
}

void App::paint_scale(NVGcontext* ctx, float x, float y, float w, float) const {
  const float width = std::min(200.0F, w - 40), left = x + w - width - 14;
  paint::box(ctx, left - 8, y + 6, width + 16, 44, ground());
  const Image colors = [] {
    Image shares(32, 1, 1);
    for (int i = 0; i < 32; ++i)
      *shares.at(i, 0) = static_cast<float>(i) / 31;
    return sweeps::error_colors(shares);
  }();
  for (int i = 0; i < 32; ++i) {
    const float* c = colors.at(i, 0);
    paint::box(ctx, left + width * static_cast<float>(i) / 32, y + 28, width / 32 + 1, 8, nvgRGBf(c[0], c[1], c[2]), 0);
  }
  paint::line(ctx, left, y + 8, width, 18, scale_words_, paint::text(), paint::kSmallText);
  paint::line(ctx, left, y + 36, width, 14, "0", paint::dim_text(), paint::kSmallText);
  paint::line(ctx, left, y + 36, width, 14, fmt::format("{:g}", scale_end_), paint::dim_text(), paint::kSmallText,
              paint::Align::right);
}

void App::paint_box(NVGcontext* ctx, float x, float y, float w, float ui_scale) const {
  const auto to_x = [&](int column) { return x + (static_cast<float>(column) - zoom_.left) * zoom_.scale / ui_scale; };
  const auto to_y = [&](int row) { return y + (static_cast<float>(row) - zoom_.top) * zoom_.scale / ui_scale; };
  paint::outline(ctx, to_x(box_.x0) - 1, to_y(box_.y0) - 1, to_x(box_.x1) - to_x(box_.x0) + 2,
                 to_y(box_.y1) - to_y(box_.y0) + 2, paint::accent(), 1);
  if (!shown_[0]) return;
  const float width = 236, left = x + w - width - 8;
  float top = y + 58;
  const auto one = [&](const std::string& name, const Image& image) {
    const BoxStatistics s = statistics_of(image, box_);
    paint::box(ctx, left, top, width, 152, ground());
    paint::line(ctx, left + 8, top + 4, width - 16, 18, fmt::format("{}: {} pixels", name, s.pixels), paint::text(),
                paint::kSmallText, paint::Align::left, true);
    const char* rows[] = {"", "mean", "deviation", "least", "largest"};
    for (int row = 0; row < 5; ++row) {
      const float at = top + 22 + static_cast<float>(row) * 14;
      paint::line(ctx, left + 8, at, 60, 14, rows[row], paint::dim_text(), paint::kSmallText);
      for (std::size_t c = 0; c < 4; ++c) {
        const char* names[] = {"red", "green", "blue", "lum."};
        const double value = row == 1 ? s.mean[c] : row == 2 ? s.deviation[c] : row == 3 ? s.min[c] : s.max[c];
        paint::line(ctx, left + 60 + static_cast<float>(c) * 43, at, 42, 14,
                    row == 0 ? names[c] : fmt::format("{:.3g}", value), row == 0 ? paint::dim_text() : paint::text(),
                    paint::kSmallText, paint::Align::right);
      }
    }
    const float base = top + 144, bar = (width - 16) / BoxStatistics::kBins;
    std::size_t most = 1;
    for (const auto& counts : s.counts)
      most = std::max(most, *std::max_element(counts.begin(), counts.end()));
    const NVGcolor colors[] = {nvgRGBA(255, 80, 80, 130), nvgRGBA(80, 220, 80, 130), nvgRGBA(90, 130, 255, 130)};
    for (std::size_t c = 0; c < 3; ++c) {
      nvgBeginPath(ctx);
      for (int i = 0; i < BoxStatistics::kBins; ++i) {
        const float height =
            46 * std::sqrt(static_cast<float>(s.counts[c][static_cast<std::size_t>(i)]) / static_cast<float>(most));
        nvgRect(ctx, left + 8 + static_cast<float>(i) * bar, base - height, bar, height);
      }
      nvgFillColor(ctx, colors[c]);
      nvgFill(ctx);
    }
    top += 158;
  };
  one(workspace_.technique(Side::a), shown_[0]->image);
  if (second_.image()) one(second_.words(), *second_.image());
}

void App::paint_times(NVGcontext* ctx, float x, float y, float w, float h) const {
  paint::box(ctx, x, y, w, h, ground());
  if (times_.empty()) return paint::line(ctx, x + 8, y, w - 16, h, "no frame yet", paint::dim_text());
  double most = 0;
  for (const FrameFigures& figures : times_)
    most = std::max(most, figures.frame_ms);
  const float bar = (w - 150) / static_cast<float>(kTimesKept), floor = y + h - 8, room = h - 30;
  std::vector<std::string> names;
  for (const auto& [pass, ms] : times_.back().pass_ms)
    names.push_back(pass);
  for (std::size_t i = 0; i < times_.size(); ++i) {
    float at = floor;
    for (std::size_t p = 0; p < times_[i].pass_ms.size(); ++p) {
      const auto& [pass, ms] = times_[i].pass_ms[p];
      const auto known = std::find(names.begin(), names.end(), pass);
      const auto height = static_cast<float>(ms / std::max(1e-6, most)) * room;
      at -= height;
      const auto color = static_cast<std::size_t>(known - names.begin());
      paint::box(ctx, x + 8 + static_cast<float>(i) * bar, at, std::max(1.0F, bar - 0.5F), height, pass_color(color),
                 0);
    }
  }
  const FrameFigures& last = times_.back();
  paint::line(ctx, x + 8, y + 3, w - 16, 18,
              fmt::format("{:.1f} ms per frame, {:.1f} frames per second shown, {:.0f} MB on the GPU", last.frame_ms,
                          frames_per_s(), static_cast<double>(shown_[0] ? shown_[0]->gpu_bytes : 0) / 1e6),
              paint::text(), paint::kSmallText);
  paint::line(ctx, x + 8, y + 20, 60, 14, fmt::format("{:.1f} ms", most), paint::dim_text(), paint::kSmallText);
  for (std::size_t p = 0; p < std::min<std::size_t>(names.size(), 6); ++p) {
    const float at = y + 22 + static_cast<float>(p) * 15;
    paint::box(ctx, x + w - 136, at + 3, 8, 8, pass_color(p), 1);
    paint::line(ctx, x + w - 124, at, 118, 14, fmt::format("{} {:.1f}", names[p], last.pass_ms[p].second),
                paint::text(), paint::kSmallText);
  }
}

}  // namespace pellucid::sandbox
