#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "algorithms/reference/reference.hpp"
#include "algorithms/scene/images/image.hpp"
#include "algorithms/scene/scene.hpp"
#include "algorithms/technique.hpp"
#include "gl/timer.hpp"

namespace pellucid {

/// Settings of the frame itself, common to all techniques; named with the prefix `frame.`.
enum class FrameFormat { half, single };
struct FrameSettings {
  FrameFormat format = FrameFormat::half;
  int supersampling = 1;
  static constexpr void parameters(auto& self, auto&& visit) {
    visit(PARAM(format), {.cite = "Imagire et al. 2007, Sec. 5",
                          .doc = "bits of a colour channel that passes blend into: 16 (half) or 32 (single)",
                          .when = Change::precompute,
                          .choices = "half|single"});
    visit(
        PARAM(supersampling),
        {.range = {1, 8},
         .cite = "Crow 1977",
         .doc = "n: a pixel is the mean of n x n samples on a grid, for comparison with a reference of many samples"});
  }
};
static_assert(well_formed<FrameSettings>());

/// A group of settings that all techniques share.
struct CommonSettings {
  std::string_view prefix;  ///< "frame", without the dot
  const ParameterTable* table;
};
/// `frame` and `shadow`.
std::span<const CommonSettings> common_settings();

/// A scene, a technique and a target of one size: what the command line, the sweep worker and the viewer render with.
/// Needs a current GL context.
class RenderSession {
 public:
  RenderSession(Scene scene, std::string_view technique, std::string_view view, int width, int height);
  ~RenderSession();
  RenderSession(RenderSession&&) noexcept;
  RenderSession& operator=(RenderSession&&) noexcept;

  /// `name` is a technique's parameter, `scene.…`, `frame.…` or `shadow.…`. Throws InputError.
  Change assign(std::string_view name, const Value&);
  Change assign_text(std::string_view name, std::string_view text);
  /// Every parameter with its current value, under the names that assign() takes.
  nlohmann::json parameters() const;
  void set_view(const View&);
  void resize(int width, int height);

  /// Brings prepare() up to date; returns its time in seconds (0 when nothing was to do).
  double prepare();
  /// Draws one frame (and prepares if need be).
  void render(gl::PassTimer&);
  Image read_color() const;  ///< RGBA, rows from the top, one texel a pixel
  /// The surfaces of the shared forward pass, at float precision, for the reference. Their shadows are exact, or, with
  /// `shadow_maps`, those of the maps that a frame draws at the present settings, errors included.
  SurfaceLayer raster_surfaces(bool shadow_maps = false);

  Scene& scene();
  const Camera& camera() const;
  Technique& technique();
  const TechniqueInfo& technique_info() const;
  const gl::Texture& color() const;
  std::string reload_shaders();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pellucid
