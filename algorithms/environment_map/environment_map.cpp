// Classical environment mapping, with proxy geometry if wanted (references.bib: blinn1976, bjorke2004).
#include "algorithms/environment_map/environment_map.hpp"

#include <string>
#include <vector>

#include "algorithms/local_cube_maps/map_frame.hpp"

namespace pellucid::environment_map {
namespace {

using local_cube_maps::RayLookup;

class EnvironmentMap final : public Technique {
 public:
  ParameterRef parameters() override { return bind_parameters(parameters_); }
  void prepare(const Scene& scene) override {
    layers_ = local_cube_maps::layers_of(parameters_.cube_pass);
    frame_.prepare(scene, maps(), lookup());
  }
  void render(const Scene& scene, const Camera& camera, ForwardPass& forward, const Target& target,
              gl::PassTimer& timer) override {
    frame_.draw_maps(scene, forward, timer, maps(), lookup());
    {
      auto pass = timer.pass("opaque");
      target.framebuffer.bind();
      forward.draw_shaded(camera, false);
    }
    frame_.draw_objects(scene, camera, forward, target, timer, maps(), lookup());
  }
  void native_errors(nlohmann::json& out) const override { frame_.native_errors({}, out); }
  std::string reload_shaders() override { return frame_.reload_shaders(); }

 private:
  local_cube_maps::MapSettings maps() const {
    // The distance is drawn along and never read.
    local_cube_maps::MapSettings maps = parameters_.settings(local_cube_maps::DistanceStore::alpha, 16);
    maps.layers = layers_;
    return maps;
  }
  local_cube_maps::LookupSettings lookup() const {
    constexpr RayLookup kLookups[] = {RayLookup::direction, RayLookup::box, RayLookup::sphere};
    return {.kind = kLookups[static_cast<int>(parameters_.parallax)],
            .search = {},
            .bare = false,
            .bounces = 1,
            .internal = 0,
            .proxy_radius_m = parameters_.proxy_radius_m};
  }

  Parameters parameters_;
  CubeLayers layers_ = CubeLayers::geometry;
  local_cube_maps::MapFrame frame_{"environment_map"};
};

}  // namespace

const ParameterTable& table() {
  return parameter_table<Parameters>();
}
std::unique_ptr<Technique> make() {
  return std::make_unique<EnvironmentMap>();
}

}  // namespace pellucid::environment_map
