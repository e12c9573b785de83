#include "sandbox/viewer/app/app.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
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
#include "sandbox/viewer/live/keep_memory.hpp"
#include "sweeps/spec/provenance.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace pellucid::sandbox {
namespace {

constexpr double kSaid_s = 6;
// The panel waits for a frame that is on its way, a quarter longer than the last one took, within these bounds.
constexpr double kHeldBackLeast_s = 0.08, kHeldBackMost_s = 0.3;
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

std::string state_as_command(const Kept& kept) {
  return sweeps::shell_line(render_words(kept.workspace.state(Side::a), "picture.png"));
}

}  // namespace

Kept::Kept(const ViewerOptions& given)
    : options(given),
      workspace(given.state, given.device, [] { gl::Window::wake(); }),
      second(workspace, given.device, [] { gl::Window::wake(); }),
      journal(given.log) {
  display.exposure_ev = given.exposure_ev;
  if (given.random_tweaks) {
    tweaking.emplace(*given.random_tweaks, given.tweak_seconds);
    workspace.want_counts();
  }
}

App::App(Kept& kept)
    : kept_(kept),
      options_(kept.options),
      window_(window_options(kept.options)),
      desk_(new Desk(window_.handle(), kept.options.ui_scale.value_or(window_.content_scale()))),
      workspace_(kept.workspace),
      second_(kept.second),
      flip_([] { gl::Window::wake(); }),
      panel_(*desk_, workspace_),
      journal_(kept.journal),
      display_(kept.display),
      zoom_(kept.zoom),
      blink_(kept.blink),
      layer_kind_(kept.layer),
      native_map_(kept.native_map),
      box_(kept.box),
      sweep_(kept.sweep) {
  pictures_.set_transform(options_.display, options_.display_view, options_.look);
  desk_->status = [this] { return status(); };
  desk_->status_is_bad = [this] { return status_is_bad(); };
  panel_.failed = [this](const std::string& why) { say(why, true); };
  desk_->paint_over = [this](NVGcontext* ctx, float x, float y, float w, float h) { paint_over(ctx, x, y, w, h); };
  make_actions();
  panel_.add_part(compare_part());
  panel_.add_part(live_part());
  panel_.add_part(display_part());
  panel_.add_part(out_part());
  panel_.add_part(frames_part());
  if (!options_.tev.empty()) tev_ = std::make_unique<TevClient>(options_.tev);
  if (!options_.shaders.empty()) {
    shader_watch_ = std::make_unique<FileWatch>([] { gl::Window::wake(); });
    shader_watch_->add_tree(options_.shaders);
  }
  if (kept_.windows++ == 0 && !options_.compare.empty()) choose_against(options_.compare);
  if (kept_.tweaking) {
    kept_.tweaking->compare = [this](const std::string& what) { guarded([&] { choose_against(what); }); };
  }
  if (sweep_) {
    thumbnail_images_.assign(sweep_->values().size(), 0);
    chart_stale_ = true;
  }
  if (!bookmarks_.trouble().empty()) say(bookmarks_.trouble(), true);
  if (!kept_.trouble.empty()) {
    say(fmt::format("the window's graphics context failed ({}); this is a new window with the same state",
                    kept_.trouble),
        true);
  }
  listen();
  glfwGetFramebufferSize(window_.handle(), &framebuffer_width_, &framebuffer_height_);
  desk_->resized();
  window_.show();
  journal_.write({{"event", "opened"}, {"pid", ::getpid()}});
}

App::~App() {
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
  if (const std::string trouble = workspace_.trouble(); !trouble.empty())
    return trouble + (shown_[0] ? " (the picture is the last one)" : "");
  if (const std::string phase = workspace_.phase(); !phase.empty()) return phase;
  const auto& picture = shown_[0];
  if (!picture) return "starting the renderer";
  const std::string pixel = pixel_words();
  if (!pixel.empty()) return pixel;
  if (kept_.frames) return frames_words();
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
    picture_came_ = true;
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
    journal_second();
  }
  if (auto found = flip_.take()) {
    flip_result_ = std::move(*found);
    changed = true;
    if (!flip_result_->trouble.empty()) say("FLIP: " + flip_result_->trouble, true);
    journal_.write({{"event", "flip"}, {"flip_mean", flip_result_->flip_mean}, {"rmse", flip_result_->rmse}});
  }
  if (changed) upload_pictures();
}

void App::tell_notes() {
  const std::vector<std::string> notes = workspace_.take_notes();
  if (notes.empty()) return;
  for (const std::string& words : notes)
    journal_.write({{"event", "told"}, {"words", words}});
  // Several that come within moments are read together.
  std::string words = fmt::format("{}", fmt::join(notes, "; "));
  if (said_.starts_with("warning: ")) words = said_ + "; " + words;
  say(words, true);
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
  if (kept_.tweaking && !kept_.tweaking->turn(workspace_)) glfwSetWindowShouldClose(window_.handle(), GLFW_TRUE);
}

void App::tick() {
  if (workspace_.poll()) panel_dirty_ = true;
  tell_notes();
  watch_files();
  show_pictures();
  fly();
  play();
  tweak();
  follow_window();
  follow_sweep();
  follow_frames();
  if (status() != drawn_status_) panel_dirty_ = true;  // the seconds count on
  if (!said_.empty() && glfwGetTime() - said_s_ >= kSaid_s) {
    said_.clear();
    panel_dirty_ = true;
  }
  if (blink_) picture_dirty_ = true;
}

void App::draw(bool with_panel) {
  const Region at = region();
  if (zoom_.fitted && shown_[0])
    zoom_.fit(at, shown_[0]->image.width, shown_[0]->image.height, effective_display().mode);
  if (with_panel || !layer_.fits(framebuffer_width_, framebuffer_height_)) {
    const bool busy = workspace_.busy();
    panel_.update();
    drawn_status_ = status();
    layer_.begin(framebuffer_width_, framebuffer_height_);
    desk_->draw_all();
    PanelLayer::end();
    panel_dirty_ = false;
    held_since_s_ = -1;
    journal_.write({{"event", "panel"}, {"busy", busy}});
  }
  if (shown_[0]) pictures_.draw(effective_display(), at, zoom_);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  pictures_.show(at, layer_.texture());
  window_.swap_buffers();
  picture_dirty_ = picture_came_ = false;
  if (!panel_dirty_) write_journal(at);
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
                  {"mode", compare_mode_name()},
                  {"generation", shown_[0] ? shown_[0]->generation : 0}});
}

std::optional<double> App::next_wake_s() const {
  if (!flying_.empty() || playing_) return 1.0 / 60;
  if (workspace_.busy() || second_.busy() || sweep_ || kept_.frames) return 0.25;
  if (blink_) return 0.1;
  if (kept_.tweaking) return 0.02;
  std::optional<double> due;
  if (const double hint = desk_->hint_due_s(); hint > 0) due = hint + 0.01;
  if (!said_.empty()) due = std::min(due.value_or(kSaid_s), std::max(0.01, said_s_ + kSaid_s - glfwGetTime()));
  return due;
}

bool App::draw_or_give_up(bool with_panel) {
  try {
    draw(with_panel);
    if (gl::Window::context_lost()) throw RuntimeError("the device was reset");
    if (options_.lose_context_at > 0 && options_.lose_context_at <= workspace_.pictures_seen() && kept_.windows == 1)
      throw RuntimeError("as --lose-context-at asks for");
    ++drawings_;
    return true;
  } catch (const RuntimeError& e) {
    // A window that cannot draw at all would follow upon itself for ever.
    if (drawings_ == 0) throw;
    kept_.trouble = e.what();
    return false;
  }
}

double App::longest_hold_s() const {
  return std::clamp(1.25 * shown_[0]->frame_ms / 1000, kHeldBackLeast_s, kHeldBackMost_s);
}

// The panel waits for a frame that comes within a moment: else the two share the processor, where that rasterises, and
// the frame comes later.
bool App::holds_back() {
  const double now = glfwGetTime();
  if (!workspace_.busy() || !shown_[0] || (held_since_s_ >= 0 && now - held_since_s_ > longest_hold_s())) {
    held_since_s_ = -1;
    return false;
  }
  if (held_since_s_ < 0) held_since_s_ = now;
  return true;
}

bool App::turn(std::optional<double> longest_s) {
  const bool dirty = panel_dirty_ || picture_dirty_;
  gl::Window::wait_events(held_since_s_ >= 0 && !picture_dirty_ ? std::optional(kHeldBackLeast_s / 4)
                          : dirty                               ? std::optional(0.0)
                                                                : longest_s);
  tick();
  const bool hint_due = desk_->hint_due_s() <= 0;
  panel_dirty_ = panel_dirty_ || (hint_due && !hint_was_due_);
  hint_was_due_ = hint_due;
  // A picture that has just come is shown before the panel is drawn, which costs as much again.
  const bool panel_due = panel_dirty_ && !holds_back() && !picture_came_;
  if (panel_due || picture_dirty_) {
    if (!draw_or_give_up(panel_due)) return false;
    if (redraws_ > 0) {
      --redraws_;
      picture_dirty_ = true;
    }
  }
  // After the window's own drawing, which would share the processor with the frame.
  if (measuring_ && !workspace_.busy() && !panel_dirty_) workspace_.ask();
  return true;
}

std::optional<int> App::run() {
  if (options_.measure) return measure();
  while (!window_.should_close())
    if (!turn(next_wake_s())) return std::nullopt;
  if (!kept_.tweaking) return 0;
  const nlohmann::json report = kept_.tweaking->report(workspace_);
  fmt::print(stderr, "{}\n", report.dump(2));
  journal_.write(report);
  return kept_.tweaking->faultless() ? 0 : 1;
}

int run_viewer(const ViewerOptions& options) {
  keep_freed_memory();
  // A pipe or a file that takes no more is an error to be told, not the end of the program.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  Kept kept(options);
  for (;;) {
    try {
      App app(kept);
      if (const std::optional<int> status = app.run()) return *status;
    } catch (const gl::NoDisplay& e) {
      throw RuntimeError(fmt::format("{}; without one: {}", e.what(), state_as_command(kept)));
    } catch (const RuntimeError& e) {
      if (kept.windows < 2) throw;
      throw RuntimeError(fmt::format("{}; the window's state: {}", e.what(), state_as_command(kept)));
    }
  }
}

}  // namespace pellucid::sandbox
