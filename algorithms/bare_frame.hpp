#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "algorithms/parameters.hpp"
#include "algorithms/raster/shadow_maps.hpp"
#include "algorithms/reference/reference.hpp"
#include "algorithms/scene/scene.hpp"
#include "algorithms/technique.hpp"
#include "gl/objects.hpp"
#include "gl/timer.hpp"

/// A technique's frame is timed against its bare frame (`pellucid bench`): the same passes with shaders that make the
/// same fetches and blends and nothing else. A technique that has one keeps it in its folder `bench` and registry.cpp
/// names it.
namespace pellucid {

/// A frame to draw: what the session that checked it shows. The references outlive the frame.
struct BareFrameRequest {
  const Scene& scene;
  const Camera& camera;
  gl::Format format;  ///< of the colour that passes blend into
  ShadowSettings shadow;
  std::vector<std::pair<std::string, std::string>> settings;  ///< of the technique's own parameters; checked
  std::function<void(gl::PassTimer&)> session_frame;          ///< the technique's frame as the session draws it
};

class BareFrame {
 public:
  virtual ~BareFrame() = default;

  /// `method`: the technique's frame; `bare`: with the bare shaders in place of its own; `shared`: the passes that both
  /// draw, alone.
  enum class Part { method, bare, shared };
  virtual void render(gl::PassTimer&, Part) = 0;

  struct Counts {
    double blends_per_pixel = 0;   ///< fragments that the bare shader is run for, over all pixels of the image
    double fetches_per_blend = 0;  ///< of the bare shader; an upper bound of the method's
  };
  /// Throws InputError when the frame shows nothing that the technique draws.
  virtual Counts counts() = 0;

  /// How far the reference must follow light to draw what the frame shows; nothing where ray tracing is no comparison.
  virtual std::optional<SurfaceOptions> reference() const { return std::nullopt; }
};

struct BareFrameInfo {
  std::string_view technique;
  const char* scene = nullptr;  ///< the one to time without another
  std::unique_ptr<BareFrame> (*make)(const BareFrameRequest&) = nullptr;
  std::string (*counts)(const nlohmann::json& parameters) = nullptr;  ///< what decides on the fetches, in words
  bool volume = false;  ///< it draws a volume, which VTK's ray casting can draw too
};

/// One for each technique that has one.
std::span<const BareFrameInfo* const> bare_frames();

/// Assigns the request's settings to a technique's own parameters.
inline void assign_settings(ParameterRef parameters, const BareFrameRequest& request, const char* technique) {
  for (const auto& [name, value] : request.settings) {
    const ParameterInfo* info = parameters.table->find(name);
    if (info != nullptr) parameters.assign(name, parse_value(*info, value, technique), technique);
  }
}

/// A technique's own parameters with the request's settings.
template <class Parameters>
Parameters parameters_of(const BareFrameRequest& request, const char* technique) {
  Parameters parameters;
  assign_settings(bind_parameters(parameters), request, technique);
  return parameters;
}

/// The target that such a frame is drawn into; it has the camera's size.
struct BareFrameTarget {
  BareFrameTarget(const Camera& camera, gl::Format format)
      : color(gl::Texture::make_2d("bench colour", format, camera.width, camera.height)),
        depth(gl::Texture::make_2d("bench depth", gl::Format::depth32f, camera.width, camera.height)),
        framebuffer("bench", {&color}, &depth) {}

  gl::Texture color, depth;
  gl::Framebuffer framebuffer;
  Target target() const { return {color, depth, framebuffer}; }
};

}  // namespace pellucid
