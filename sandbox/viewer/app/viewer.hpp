#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "sandbox/viewer/display/picture_view.hpp"
#include "sandbox/viewer/state/view_state.hpp"

namespace pellucid::sandbox {

struct ViewerOptions {
  ViewState state;
  bool size_follows_window = false;
  std::optional<int> device;                ///< EGL device of the renderers
  std::optional<float> ui_scale;            ///< without it the monitor's
  int window_width = 0, window_height = 0;  ///< 0: to fit the picture and the panel
  std::string display, display_view, look;  ///< of the OpenColorIO config; empty: its default
  float exposure_ev = 0;
  std::filesystem::path folder = ".";          ///< where pictures and stores are saved
  std::filesystem::path shaders;               ///< folder whose shaders replace the embedded ones; watched
  std::string compare;                         ///< a technique, `reference`, or a picture's file; empty: none
  std::string tev;                             ///< HOST:PORT; empty: none
  std::optional<std::uint64_t> random_tweaks;  ///< seed
  double tweak_seconds = 60;
  bool measure = false, json = false;  ///< measures itself and prints the figures
  std::uint64_t lose_context_at = 0;   ///< for tests: after so many pictures the context counts as lost; 0: never
  std::filesystem::path log;           ///< what the window shows, as JSON lines; empty: none
};

/// Opens the window and runs until it is closed. Throws RuntimeError when there is no display.
int run_viewer(const ViewerOptions&);

}  // namespace pellucid::sandbox
