// Translucent relief's frame, and the same with a bare shader in place of its own.
#include "algorithms/translucent_relief/bench/bare_relief.hpp"

#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/raster/forward_pass.hpp"
#include "algorithms/translucent_relief/relief_pass.hpp"
#include "algorithms/translucent_relief/translucent_relief.hpp"
#include "gl/context.hpp"
#include "gl/error.hpp"

namespace pellucid::translucent_relief {
namespace {

constexpr const char* kName = "translucent_relief";

/// The bare shader makes as many fetches at each pixel as the technique did there.
class BareRelief final : public BareFrame {
 public:
  explicit BareRelief(const BareFrameRequest& request)
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
    pass_.update(scene_, forward_);
    {
      auto pass = timer.pass("opaque");
      target_.framebuffer.bind();
      forward_.draw_opaque(camera_, false);
    }
    {
      auto pass = timer.pass("relief");
      if (part == Part::method) pass_.draw(scene_, camera_, forward_, target_.target());
      if (part == Part::bare) pass_.draw_bare(scene_, camera_, forward_);
    }
    auto pass = timer.pass("background");
    forward_.draw_background(camera_);
    timer.end_frame();
    gl::check("bench", kName);
  }

  /// Over the pixels that show a relief; the fetches are the mean of theirs.
  Counts counts() override {
    gl::PassTimer untimed;
    render(untimed, Part::shared);
    const ReliefPass::FetchCounts counts = pass_.count_fetches(scene_, camera_, forward_);
    if (counts.pixels == 0) {
      throw InputError(fmt::format("bench: {} shows no relief in view {}, {}x{}", scene_.name, camera_.view.name,
                                   camera_.width, camera_.height));
    }
    return {counts.pixels / (static_cast<double>(camera_.width) * camera_.height), counts.fetches / counts.pixels};
  }

  std::optional<SurfaceOptions> reference() const override { return SurfaceOptions{}; }

 private:
  const Scene& scene_;
  Camera camera_;
  Parameters parameters_;
  ShadowSettings shadow_;
  ForwardPass forward_;
  ReliefPass pass_;
  BareFrameTarget target_;
};

}  // namespace

const BareFrameInfo& bare_frame() {
  static constexpr BareFrameInfo kInfo{.technique = "translucent_relief",
                                       .scene = "blue_medium",
                                       .make = [](const BareFrameRequest& request) -> std::unique_ptr<BareFrame> {
                                         return std::make_unique<BareRelief>(request);
                                       },
                                       .counts =
                                           [](const nlohmann::json& p) {
                                             return fmt::format(
                                                 "search {}, at most {} steps of view rays and {} of light rays",
                                                 p.at("search").get<std::string>(), p.at("view_steps").get<int>(),
                                                 p.at("light_steps").get<int>());
                                           }};
  return kInfo;
}

}  // namespace pellucid::translucent_relief
