#include "sandbox/viewer/app/app.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <tuple>
#include <utility>

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "gl/context.hpp"
#include "gl/error.hpp"
#include "sweeps/spec/provenance.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace pellucid::sandbox {
namespace {

constexpr double kSaid_s = 6;
constexpr int kStatusHeight = 22;

std::string title(const ViewState& state) {
  return fmt::format("{} of {} – Pellucid", state.technique, state.scene);
}

gl::WindowOptions window_options(const ViewerOptions& options) {
  gl::WindowOptions out;
  out.title = title(options.state);
  out.width = options.window_width > 0 ? options.window_width : std::max(900, options.state.width + 360);
  out.height = options.window_height > 0 ? options.window_height : std::max(600, options.state.height + 40);
  return out;
}

}  // namespace

App::App(const ViewerOptions& options)
    : options_(options),
      window_(window_options(options)),
      desk_(new Desk(window_.handle(), options.ui_scale.value_or(window_.content_scale()))),
      workspace_(options.state, options.device, [] { gl::Window::wake(); }),
      second_(workspace_, options.device, [] { gl::Window::wake(); }),
      flip_([] { gl::Window::wake(); }),
      panel_(*desk_, workspace_),
      journal_(options.log) {
  display_.exposure_ev = options.exposure_ev;
  pictures_.set_transform(options.display, options.display_view, options.look);
  desk_->status = [this] { return status(); };
  desk_->status_is_bad = [this] { return status_is_bad(); };
  panel_.failed = [this](const std::string& why) { say(why, true); };
  desk_->paint_over = [this](NVGcontext* ctx, float x, float y, float w, float h) { paint_over(ctx, x, y, w, h); };
  make_actions();
  panel_.add_part(compare_part());
  panel_.add_part(live_part());
  panel_.add_part(display_part());
  panel_.add_part(out_part());
  if (!options.tev.empty()) tev_ = std::make_unique<TevClient>(options.tev);
  if (!options.shaders.empty()) {
    shader_watch_ = std::make_unique<FileWatch>([] { gl::Window::wake(); });
    shader_watch_->add_tree(options.shaders);
  }
  if (!options.compare.empty()) choose_against(options.compare);
  if (options.random_tweaks) tweaks_.emplace(*options.random_tweaks);
  if (!bookmarks_.trouble().empty()) say(bookmarks_.trouble(), true);
  listen();
  glfwGetFramebufferSize(window_.handle(), &framebuffer_width_, &framebuffer_height_);
  desk_->resized();
  window_.show();
  journal_.write({{"event", "opened"}, {"pid", ::getpid()}});
}

App::~App() {
  sweep_.reset();
  desk_ = nullptr;  // NanoVG's objects go before the context
}

void App::say(const std::string& words, bool bad) {
  said_ = words;
  said_bad_ = bad;
  said_s_ = glfwGetTime();
  panel_dirty_ = true;
}

void App::guarded(const std::function<void()>& work) {
  try {
    work();
  } catch (const std::exception& e) {
    say(e.what(), true);
  }
}

Region App::region() const {
  const float scale = desk_->ui_scale();
  Region out;
  out.x = static_cast<int>(static_cast<float>(desk_->panel_width()) * scale);
  out.width = std::max(1, framebuffer_width_ - out.x);
  out.height = std::max(1, framebuffer_height_ - static_cast<int>(kStatusHeight * scale));
  return out;
}

std::pair<int, int> App::pixel_at_pointer() const {
  const Region at = region();
  double x = pointer_x_ - at.x;
  const double y = pointer_y_ - at.y;
  if (effective_display().mode == CompareMode::side_by_side && x >= at.width / 2) x -= at.width / 2;
  return {static_cast<int>(std::floor(zoom_.left + static_cast<float>(x) / zoom_.scale)),
          static_cast<int>(std::floor(zoom_.top + static_cast<float>(y) / zoom_.scale))};
}

std::string App::pixel_words() const {
  const auto& picture = shown_[0];
  const Region at = region();
  const double x = pointer_x_ - at.x, y = pointer_y_ - at.y;
  if (!picture || x < 0 || y < 0 || x >= at.width || y >= at.height) return "";
  const auto [column, row] = pixel_at_pointer();
  const Image& image = picture->image;
  if (column < 0 || row < 0 || column >= image.width || row >= image.height) return "";
  const float* p = image.at(column, row);
  std::string words = fmt::format("({}, {}): {:.5g} {:.5g} {:.5g}, alpha {:.4g}", column, row, p[0], p[1], p[2], p[3]);
  if (const auto& b = second_.image()) {
    const float* q = b->at(column * b->width / image.width, row * b->height / image.height);
    words += "   B:";
    for (int c = 0; c < b->channels; ++c)
      words += fmt::format(" {:.5g}", q[c]);
  }
  if (layer_kind_ == Layer::native) {
    for (const NativeMap& map : picture->maps)
      if (map.name == native_map_ && column < map.values.width && row < map.values.height)
        words += fmt::format("   {} {:.5g} {}", map.name, *map.values.at(column, row), map.unit);
  }
  if (layer_kind_ == Layer::flip && flip_result_ && flip_result_->map.width == image.width &&
      flip_result_->map.height == image.height)
    words += fmt::format("   FLIP {:.4g}", *flip_result_->map.at(column, row));
  return words;
}

bool App::status_is_bad() const {
  const bool said = !said_.empty() && glfwGetTime() - said_s_ < kSaid_s;
  return said ? said_bad_ : !workspace_.shader_error().empty() || !workspace_.trouble().empty();
}

std::string App::status() const {
  if (!said_.empty() && glfwGetTime() - said_s_ < kSaid_s) return said_;
  if (!workspace_.shader_error().empty()) {
    const std::string& error = workspace_.shader_error();
    return "the last good shaders go on: " + error.substr(0, error.find('\n'));
  }
  if (!workspace_.trouble().empty()) return workspace_.trouble() + (shown_[0] ? " (the picture is the last one)" : "");
  if (const std::string phase = workspace_.phase(); !phase.empty()) return phase;
  const auto& picture = shown_[0];
  if (!picture) return "starting the renderer";
  const std::string pixel = pixel_words();
  if (!pixel.empty()) return pixel;
  return fmt::format("{}x{}, {:.1f} ms ({}), {:.0f} MB on {}   ? shows the keys", picture->image.width,
                     picture->image.height, picture->frame_ms, picture->clock,
                     static_cast<double>(picture->gpu_bytes) / 1e6, picture->device);
}

void App::show_pictures() {
  bool changed = std::exchange(layer_changed_, false);
  for (const Side side : {Side::a, Side::b}) {
    const auto i = static_cast<std::size_t>(side);
    if (workspace_.picture(side) == shown_[i]) continue;
    shown_[i] = workspace_.picture(side);
    changed = true;
    if (!shown_[i]) continue;
    const Picture& picture = *shown_[i];
    if (side == Side::a) {
      window_.set_title(title(picture.state));
      times_.push_back({picture.frame_ms, glfwGetTime(), picture.pass_ms});
      if (times_.size() > kTimesKept) times_.pop_front();
      if (tev_) guarded([&] { tev_->send(picture.state.technique + " of " + picture.state.scene, picture.image); });
    }
    if (journal_.on()) {
      journal_.write({{"event", "picture"},
                      {"side", side == Side::a ? "a" : "b"},
                      {"generation", picture.generation},
                      {"stale", workspace_.stale(side)},
                      {"frame_ms", picture.frame_ms},
                      {"prepare_s", picture.prepare_s},
                      {"gpu_bytes", picture.gpu_bytes},
                      {"recipe", picture.recipe}});
    }
  }
  if (second_.poll()) {
    changed = true;
    if (journal_.on() && second_.image())
      journal_.write({{"event", "second"}, {"width", second_.image()->width}, {"words", second_.words()}});
  }
  if (auto found = flip_.take()) {
    flip_result_ = std::move(*found);
    changed = true;
    if (!flip_result_->trouble.empty()) say("FLIP: " + flip_result_->trouble, true);
    journal_.write({{"event", "flip"}, {"flip_mean", flip_result_->flip_mean}, {"rmse", flip_result_->rmse}});
  }
  if (changed) upload_pictures();
}

void App::follow_window() {
  if (!options_.size_follows_window) return;
  const Region at = region();
  workspace_.set_size(at.width, at.height);
}

void App::play() {
  if (!playing_ || workspace_.busy()) return;
  const ParameterInfo* time = workspace_.info(Side::a, "scene.time_s");
  if (time == nullptr) {
    playing_ = false;
    return say("this scene has no scene.time_s to play", true);
  }
  const double now = glfwGetTime();
  double at = std::get<double>(workspace_.get(Side::a, "scene.time_s")) + (now - played_s_);
  played_s_ = now;
  if (at > time->max) at = time->min;
  guarded([&] { workspace_.set(Side::a, "scene.time_s", std::round(at * 1000) / 1000); });
}

void App::watch_files() {
  if (!shader_watch_) return;
  bool shaders = false;
  for (const auto& path : shader_watch_->changed())
    shaders = shaders || path.extension() == ".glsl";
  if (!shaders) return;
  workspace_.reload_shaders();
  const std::string own = pictures_.reload_shaders();
  if (!own.empty()) say(own, true);
}

void App::tweak() {
  if (!tweaks_) return;
  if (const std::string words = RandomTweaks::disagreement(workspace_); !words.empty()) {
    ++disagreements_;
    fault_ = words;
  }
  tweaks_->step(workspace_);
  if (glfwGetTime() - began_s_ > options_.tweak_seconds) glfwSetWindowShouldClose(window_.handle(), GLFW_TRUE);
}

void App::tick() {
  if (workspace_.poll()) panel_dirty_ = true;
  watch_files();
  show_pictures();
  fly();
  play();
  tweak();
  follow_window();
  if (measuring_ && !workspace_.busy()) workspace_.ask();
  follow_sweep();
  if (workspace_.busy()) panel_dirty_ = true;  // the seconds count on
  if (!said_.empty() && glfwGetTime() - said_s_ >= kSaid_s) {
    said_.clear();
    panel_dirty_ = true;
  }
  if (blink_) picture_dirty_ = true;
}

void App::draw() {
  const Region at = region();
  if (zoom_.fitted && shown_[0])
    zoom_.fit(at, shown_[0]->image.width, shown_[0]->image.height, effective_display().mode);
  if (panel_dirty_) {
    panel_.update();
    layer_.begin(framebuffer_width_, framebuffer_height_);
    desk_->draw_all();
    PanelLayer::end();
  }
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, framebuffer_width_, framebuffer_height_);
  glDisable(GL_SCISSOR_TEST);
  glClearColor(0.11F, 0.115F, 0.125F, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  if (shown_[0]) pictures_.draw(effective_display(), at, zoom_, framebuffer_height_);
  pictures_.draw_layer(layer_.texture());
  window_.swap_buffers();
  panel_dirty_ = picture_dirty_ = false;
  write_journal(at);
}

void App::write_journal(const Region& at) {
  if (!journal_.on()) return;
  journal_.places(*desk_);
  journal_.status(status());
  journal_.focus(*desk_);
  journal_.drawn({{"event", "drawn"},
                  {"framebuffer", {framebuffer_width_, framebuffer_height_}},
                  {"region", {at.x, at.y, at.width, at.height}},
                  {"scale", zoom_.scale},
                  {"left", zoom_.left},
                  {"top", zoom_.top},
                  {"generation", shown_[0] ? shown_[0]->generation : 0}});
}

std::optional<double> App::next_wake_s() const {
  if (!flying_.empty() || playing_) return 1.0 / 60;
  if (workspace_.busy() || second_.busy() || sweep_) return 0.25;
  if (blink_) return 0.1;
  if (tweaks_) return 0.02;
  std::optional<double> due;
  if (const double hint = desk_->hint_due_s(); hint > 0) due = hint + 0.01;
  if (!said_.empty()) due = std::min(due.value_or(kSaid_s), std::max(0.01, said_s_ + kSaid_s - glfwGetTime()));
  return due;
}

int App::run() {
  bool hint_was_due = false;
  began_s_ = glfwGetTime();
  while (!window_.should_close()) {
    gl::Window::wait_events(panel_dirty_ || picture_dirty_ ? std::optional(0.0) : next_wake_s());
    tick();
    const bool hint_due = desk_->hint_due_s() <= 0;
    panel_dirty_ = panel_dirty_ || (hint_due && !hint_was_due);
    hint_was_due = hint_due;
    if (panel_dirty_ || picture_dirty_) {
      draw();
      if (redraws_ > 0) {
        --redraws_;
        picture_dirty_ = true;
      }
    }
  }
  if (tweaks_) {
    fmt::print(stderr, "{} tweaks, {} pictures, {} of another state than the panel's{}\n", tweaks_->steps(),
               workspace_.pictures_seen(), disagreements_, fault_.empty() ? "" : ": " + fault_);
    journal_.write({{"event", "tweaks"},
                    {"steps", tweaks_->steps()},
                    {"pictures", workspace_.pictures_seen()},
                    {"disagreements", disagreements_},
                    {"fault", fault_}});
  }
  return disagreements_ > 0 ? 1 : 0;
}

int run_viewer(const ViewerOptions& options) {
  try {
    return App(options).run();
  } catch (const gl::NoDisplay& e) {
    const std::string command = sweeps::shell_line(render_words(options.state, "picture.png"));
    throw RuntimeError(fmt::format("{}; without one: {}", e.what(), command));
  }
}

}  // namespace pellucid::sandbox
