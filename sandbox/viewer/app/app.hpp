#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "gl/window.hpp"
#include "sandbox/viewer/app/kept.hpp"
#include "sandbox/viewer/app/panel_view.hpp"
#include "sandbox/viewer/compare/flip_job.hpp"
#include "sandbox/viewer/display/panel_layer.hpp"
#include "sandbox/viewer/display/picture_view.hpp"
#include "sandbox/viewer/live/file_watch.hpp"
#include "sandbox/viewer/out/tev_client.hpp"
#include "sandbox/viewer/panel/controls.hpp"
#include "sandbox/viewer/state/bookmarks.hpp"

namespace pellucid::sandbox {

/// Something the user does with one key; the page of keys and the panel's buttons come from the same list.
struct Action {
  int key = 0, modifiers = 0;
  std::string keys;     ///< as the page of keys writes it: "Ctrl+S"
  std::string meaning;  ///< one line
  std::function<void()> run;
};

/// The times of one frame, for the graph.
struct FrameFigures {
  double frame_ms = 0, shown_s = 0;
  std::vector<std::pair<std::string, double>> pass_ms;
};
inline constexpr std::size_t kTimesKept = 120;

/// The window: what it shows, and what its events do.
class App {
 public:
  explicit App(Kept&);
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;
  /// The exit status: 0, or 1 when random tweaking found a fault. Nothing when the graphics context failed
  /// (Kept::trouble tells how): another window has to go on.
  std::optional<int> run();

 private:
  // actions.cpp
  void make_actions();
  bool act(int key, int modifiers);
  void save(const std::string& extension);
  void save_crop();
  void copy_command();
  void copy(const std::string& text, const std::string& what);
  // input.cpp
  void listen();
  void on_mouse_button(int button, int action, int modifiers);
  void on_mouse_moved(double x, double y);
  void on_scrolled(double by, int modifiers);
  bool on_key(int key, int action, int modifiers);
  void move_camera(const View&);
  void drag_object(const View&, float dx, float dy);
  void fly();
  // panel_parts.cpp
  PanelPart display_part();
  PanelPart out_part();
  // compare_parts.cpp
  PanelPart compare_part();
  PanelPart live_part();
  void choose_against(const std::string&);
  void journal_second();
  void next_mode();
  void set_mode(std::size_t mode);
  std::size_t compare_mode() const;
  const std::string& compare_mode_name() const;
  void choose_layer(const std::string&);
  std::vector<std::string> layers() const;
  DisplaySettings effective_display() const;
  void upload_pictures();
  // sweep_parts.cpp
  void sweep_here();
  void follow_sweep();
  bool sweep_clicked(double x, double y);
  void add_axis();
  void go_to_bookmark(const std::string&);
  void keep_bookmark();
  void remove_bookmark();
  void copy_picture(const std::string& extension);
  // frame_parts.cpp
  PanelPart frames_part();
  void add_stop();
  void render_frames();
  bool stop_frames();
  void follow_frames();
  std::string frames_words() const;
  // measure.cpp
  int measure();
  double until(const char* what, const std::function<bool()>& reached);
  bool shows_the_picture() const;  ///< of the panel's state
  bool shows_the_state() const;    ///< the same, and the panel is drawn
  std::pair<double, double> measure_frames();
  std::vector<double> measure_typing();
  std::vector<double> measure_saving();
  double measure_idling();
  // overlays.cpp
  void paint_over(NVGcontext*, float x, float y, float w, float h);
  void paint_scale(NVGcontext*, float x, float y, float w, float h) const;
  void paint_box(NVGcontext*, float x, float y, float w, float ui_scale) const;
  void paint_times(NVGcontext*, float x, float y, float w, float h) const;
  void paint_sweep(NVGcontext*, float x, float y, float w, float h);
  double frames_per_s() const;
  // app.cpp
  void tick();
  void draw(bool with_panel);
  bool draw_or_give_up(bool with_panel);
  bool holds_back();
  double longest_hold_s() const;
  bool turn(std::optional<double> longest_s);  ///< of the loop; false when the graphics context failed
  void write_journal(const Region&);
  void show_pictures();
  void follow_window();
  void tell_notes();
  void play();
  void watch_files();
  void tweak();
  std::string status() const;
  bool status_is_bad() const;
  std::string pixel_words() const;
  std::pair<int, int> pixel_at_pointer() const;  ///< column and row; may lie outside
  std::optional<double> next_wake_s() const;
  void say(const std::string& words, bool bad = false);
  void guarded(const std::function<void()>&);
  Region region() const;

  Kept& kept_;
  ViewerOptions& options_;
  gl::Window window_;
  nanogui::ref<Desk> desk_;
  PictureView pictures_;
  PanelLayer layer_;
  Workspace& workspace_;
  Second& second_;
  FlipJob flip_;
  PanelView panel_;
  Journal& journal_;
  DisplaySettings& display_;
  Zoom& zoom_;
  SliderBar* exposure_ = nullptr;
  std::vector<Action> actions_;

  bool panel_dirty_ = true, picture_dirty_ = true;
  bool picture_came_ = false;  ///< from a renderer, and was not drawn yet
  int drawings_ = 0;           ///< that went well
  bool hint_was_due_ = false;
  double held_since_s_ = -1;  ///< a drawing is held back; negative: none is
  std::string drawn_status_;
  int redraws_ = 0;  ///< drawings that are still due after the window has a new size
  std::array<std::shared_ptr<const Picture>, 2> shown_{};
  int framebuffer_width_ = 0, framebuffer_height_ = 0;
  double pointer_x_ = 0, pointer_y_ = 0;  ///< framebuffer pixels
  int dragging_ = -1, drag_modifiers_ = 0;
  bool drags_wipe_ = false;

  // comparing
  bool& blink_;
  bool layer_changed_ = false, layer_shown_ = false;
  Layer& layer_kind_;
  std::string& native_map_;
  std::string scale_words_;
  double scale_end_ = 1;
  std::optional<FlipResult> flip_result_;
  std::shared_ptr<const Image> flip_asked_a_, flip_asked_b_;
  PixelBox& box_;
  Choice* against_choice_ = nullptr;
  Choice* technique_b_choice_ = nullptr;
  Choice* mode_choice_ = nullptr;
  Choice* layer_choice_ = nullptr;
  SliderBar* gain_slider_ = nullptr;
  Field* against_field_ = nullptr;
  Note* compare_note_ = nullptr;
  PushButton* side_button_ = nullptr;
  Choice* bookmark_choice_ = nullptr;
  Field* bookmark_name_ = nullptr;
  std::string bookmark_named_;  ///< as the field says
  Field *frames_field_ = nullptr, *fps_field_ = nullptr;
  Note* frames_note_ = nullptr;

  // live figures
  bool graph_ = false, measuring_ = false;
  std::deque<FrameFigures> times_;

  // sweep here
  std::unique_ptr<SweepHere>& sweep_;
  int chart_image_ = 0, chart_width_ = 0, chart_height_ = 0;
  std::vector<int> thumbnail_images_;
  bool chart_stale_ = false;
  std::array<float, 4> chart_place_{};

  // out
  Bookmarks bookmarks_;
  std::unique_ptr<TevClient> tev_;
  std::unique_ptr<FileWatch> shader_watch_;
  std::set<int> flying_;  ///< keys held
  double flown_s_ = 0;
  bool playing_ = false;
  double played_s_ = 0;
  std::string said_;
  bool said_bad_ = false;
  double said_s_ = 0;
};

}  // namespace pellucid::sandbox
