#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "algorithms/scene/scene.hpp"
#include "algorithms/technique.hpp"
#include "gl/live_objects.hpp"
#include "sandbox/viewer/state/view_state.hpp"

/// The renderer's messages to the window (render_worker.hpp).
namespace pellucid::sandbox {

/// A finished frame, never changed again. Its pixels are those that `pellucid render` writes for the same state.
struct Picture {
  std::uint64_t generation = 0;  ///< of the request that asked for it
  ViewState state;
  nlohmann::json recipe;  ///< of the frame, every parameter given
  Image image;            ///< RGBA, scene-linear
  std::vector<NativeMap> maps;
  double frame_ms = 0, prepare_s = 0;
  std::vector<std::pair<std::string, double>> pass_ms;
  std::string clock;
  std::size_t gpu_bytes = 0;
  nlohmann::json native_errors;
  std::string scene_hash, device, driver;
  /// For a reference: how far it has converged, in words; empty for a technique's frame.
  std::string quality;
  bool converged = true;
  /// The renderer's GL objects where they were asked for, and those that the session before this left behind.
  gl::LiveObjects objects;
  std::string objects_left;
};

/// The facts about a scene that has been loaded.
struct LoadedScene {
  std::string scene;
  std::vector<View> views;
  std::vector<ParameterInfo> parameters;  ///< without the prefix `scene.`
};

struct PhaseEvent {
  std::uint64_t generation = 0;
  std::string words;
  double share = -1;  ///< done so far, 0 to 1; negative where nobody knows
};
struct SceneEvent {
  std::uint64_t generation = 0;
  LoadedScene loaded;
};
struct PictureEvent {
  std::shared_ptr<const Picture> picture;
};
struct RefusedEvent {  ///< a state that cannot be drawn; the last picture stays
  std::uint64_t generation = 0;
  std::string reason;
  bool failed = false;  ///< not the state's fault but the program's or the driver's; another renderer draws the next
};
struct ShadersEvent {
  std::string error;  ///< the compiler's words, empty when all is well
};
struct EndedEvent {  ///< the renderer's process is gone; the next request starts another
  std::uint64_t generation = 0;
  std::string reason;  ///< empty after cancel()
};
struct ToldEvent {  ///< a warning, or another line that `pellucid render` prints to standard error
  std::string words;
};
using RenderEvent =
    std::variant<PhaseEvent, SceneEvent, PictureEvent, RefusedEvent, ShadersEvent, EndedEvent, ToldEvent>;

}  // namespace pellucid::sandbox
