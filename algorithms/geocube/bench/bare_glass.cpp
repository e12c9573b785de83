// The geocube's frame with its cubes made once, and the same with a bare shader in place of the search.
#include "algorithms/geocube/bench/bare_glass.hpp"

#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/geocube/geocube.hpp"
#include "algorithms/geocube/glass_pass.hpp"
#include "algorithms/raster/forward_pass.hpp"
#include "gl/context.hpp"
#include "gl/error.hpp"

namespace pellucid::geocube {
namespace {

constexpr const char* kName = "geocube";

/// The bare shader makes as many fetches at each pixel as the search did there. The shared passes include the entries.
class BareGlass final : public BareFrame {
 public:
  explicit BareGlass(const BareFrameRequest& request)
      : scene_(request.scene),
        camera_(request.camera),
        parameters_(parameters_of<Parameters>(request, kName)),
        shadow_(request.shadow),
        forward_(scene_),
        pass_(parameters_),
        target_(camera_, request.format) {
    forward_.update_shadows(scene_, shadow_);
    pass_.prepare(scene_);
  }

  void render(gl::PassTimer& timer, Part part) override {
    timer.begin_frame();
    if (forward_.shadowed()) forward_.update_shadows(scene_, shadow_);
    pass_.draw_entries(scene_, camera_, forward_, target_.target(), timer);
    if (part == Part::method) pass_.draw_glass(scene_, camera_, target_.target());
    if (part == Part::bare) pass_.draw_bare(scene_, camera_, target_.target());
    timer.end_frame();
    gl::check("bench", kName);
  }

  /// Over the pixels that show a dielectric; the fetches are the mean of theirs.
  Counts counts() override {
    gl::PassTimer untimed;
    render(untimed, Part::shared);
    const FetchCounts counts = pass_.count_fetches(scene_, camera_, forward_);
    if (counts.pixels == 0) {
      throw InputError(fmt::format("bench: {} shows no dielectric in view {}, {}x{}", scene_.name, camera_.view.name,
                                   camera_.width, camera_.height));
    }
    return {counts.pixels / (static_cast<double>(camera_.width) * camera_.height), counts.fetches / counts.pixels};
  }

  /// As far as the frame follows light: in, `reflections` times on inside, and out.
  std::optional<SurfaceOptions> reference() const override {
    SurfaceOptions options;
    options.reflections = parameters_.reflections;
    options.depth = 2 + parameters_.reflections;
    options.cut = static_cast<double>(parameters_.cut);
    return options;
  }

 private:
  const Scene& scene_;
  Camera camera_;
  Parameters parameters_;
  ShadowSettings shadow_;
  ForwardPass forward_;
  GlassPass pass_;
  BareFrameTarget target_;
};

}  // namespace

const BareFrameInfo& bare_frame() {
  static constexpr BareFrameInfo kInfo{.technique = "geocube",
                                       .scene = "glass_bunny",
                                       .make = [](const BareFrameRequest& request) -> std::unique_ptr<BareFrame> {
                                         return std::make_unique<BareGlass>(request);
                                       },
                                       .counts =
                                           [](const nlohmann::json& p) {
                                             return fmt::format("at most {} steps, reflections {}",
                                                                p.at("iterations").get<int>(),
                                                                p.at("reflections").get<int>());
                                           }};
  return kInfo;
}

}  // namespace pellucid::geocube
