#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sandbox/viewer/app/journal.hpp"
#include "sandbox/viewer/app/tweaking.hpp"
#include "sandbox/viewer/app/viewer.hpp"
#include "sandbox/viewer/compare/second.hpp"
#include "sandbox/viewer/compare/statistics.hpp"
#include "sandbox/viewer/display/picture_view.hpp"
#include "sandbox/viewer/live/frame_series.hpp"
#include "sandbox/viewer/live/sweep_here.hpp"
#include "sandbox/viewer/state/workspace.hpp"

namespace pellucid::sandbox {

/// The surface that is drawn in place of the picture.
enum class Layer { picture, flip, native };

/// All that belongs to no graphics context. It outlives a window whose context was lost, and the next window goes on
/// with it.
struct Kept {
  explicit Kept(const ViewerOptions&);
  ViewerOptions options;  ///< with the display transform as it was chosen since
  Workspace workspace;
  Second second;
  Journal journal;
  DisplaySettings display;
  Zoom zoom;
  PixelBox box;
  bool blink = false;
  Layer layer = Layer::picture;
  std::string native_map;
  std::unique_ptr<SweepHere> sweep;
  std::unique_ptr<FrameSeries> frames;
  std::vector<std::string> way;  ///< views that the camera of `frames` goes through
  std::string frames_text = "0:59", fps_text = "30";
  std::optional<Tweaking> tweaking;
  int windows = 0;      ///< opened so far
  std::string trouble;  ///< why the window before this one was closed
};

}  // namespace pellucid::sandbox
