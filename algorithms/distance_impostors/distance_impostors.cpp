// Szirmay-Kalos et al. 2005 (references.bib: szirmaykalos2005).
#include "algorithms/distance_impostors/distance_impostors.hpp"

#include <cstddef>
#include <string>
#include <vector>

#include "algorithms/distance_impostors/caustics.hpp"
#include "algorithms/local_cube_maps/map_frame.hpp"

namespace pellucid::distance_impostors {

using local_cube_maps::MapFrame;
using local_cube_maps::RayLookup;

namespace {

class DistanceImpostors final : public Technique {
 public:
  ParameterRef parameters() override { return bind_parameters(parameters_); }
  void prepare(const Scene& scene) override {
    maps_ = map_settings(parameters_);
    frame_.prepare(scene, maps_, lookup_settings(parameters_));
    caustics_.prepare(scene, caustic_settings(), maps_, frame_.objects());
    scene_ = nullptr;
  }
  void render(const Scene& scene, const Camera& camera, ForwardPass& forward, const Target& target,
              gl::PassTimer& timer) override {
    // The sources of the maps change with prepare() alone; the time at which they are drawn again changes freely.
    MapSettings maps = map_settings(parameters_);
    maps.layers = maps_.layers;
    const LookupSettings lookup = lookup_settings(parameters_);
    const std::vector<std::size_t> due = frame_.draw_maps(scene, forward, timer, maps, lookup);
    if (parameters_.caustics) {
      auto pass = timer.pass("caustics");
      caustics_.update(scene, forward, frame_.objects(), maps, lookup, due);
    }
    {
      auto pass = timer.pass("opaque");
      target.framebuffer.bind();
      forward.draw_shaded(camera, false);
      caustics_.draw(scene, camera);
    }
    frame_.draw_objects(scene, camera, forward, target, timer, maps, lookup);
    scene_ = &scene;
  }
  void native_errors(nlohmann::json& out) const override {
    if (scene_ != nullptr && parameters_.caustics) compare_caustics(caustics_, *scene_, out);
    frame_.native_errors(caustics_.warnings(), out);
  }
  std::vector<NativeMap> native_maps() const override { return frame_.native_maps(); }
  std::string reload_shaders() override { return frame_.reload_shaders() + caustics_.reload_shaders(); }

 private:
  CausticSettings caustic_settings() const {
    const Parameters& p = parameters_;
    return {.enabled = p.caustics,
            .map_size = p.caustic_size,
            .light_map_size = p.light_map_size,
            .sigma_texels = p.splat_sigma,
            .every_frame = p.caustic_refresh == CausticRefresh::every_frame};
  }

  Parameters parameters_;
  MapSettings maps_;
  MapFrame frame_{"distance_impostors"};
  Caustics caustics_;
  const Scene* scene_ = nullptr;  // of the last frame, for native_errors()
};

}  // namespace

MapSettings map_settings(const Parameters& p) {
  return p.settings(p.distance, p.refractor_size);
}

LookupSettings lookup_settings(const Parameters& p) {
  return {.kind = RayLookup::search,
          .search = {p.iterations, p.scheme, p.linear_steps},
          .bare = false,
          .bounces = p.bounces,
          .internal = p.internal_reflections,
          .proxy_radius_m = 0,
          .translucency = translucency_settings(p.transfer)};
}

const ParameterTable& table() {
  return parameter_table<Parameters>();
}
std::unique_ptr<Technique> make() {
  return std::make_unique<DistanceImpostors>();
}

}  // namespace pellucid::distance_impostors
