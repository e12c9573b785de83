// Classical environment mapping, with proxy geometry if wanted (references.bib: blinn1976, bjorke2004).
#include "algorithms/environment_map/environment_map.hpp"

#include <string>

#include "algorithms/distance_impostors/localized.hpp"

namespace pellucid::environment_map {
namespace {

class EnvironmentMap final : public Technique {
 public:
  ParameterRef parameters() override { return bind_parameters(parameters_); }
  void prepare(const Scene& scene) override {
    layers_ = distance_impostors::layers_of(parameters_.cube_pass);
    localized_.prepare(scene, maps(), lookup());
  }
  void render(const Scene& scene, const Camera& camera, ForwardPass& forward, const Target& target,
              gl::PassTimer& timer) override {
    localized_.render(scene, camera, forward, target, timer, maps(), lookup());
  }
  void native_errors(nlohmann::json& out) const override { localized_.native_errors(out); }
  std::string reload_shaders() override { return localized_.reload_shaders(); }

 private:
  distance_impostors::MapSettings maps() const {
    const Parameters& p = parameters_;
    return {.cube_size = p.cube_size,
            .format = p.cube_format,
            .store = distance_impostors::DistanceStore::alpha,  // it is drawn along and never read
            .layers = layers_,
            .anchor = p.reference_point,
            .anchor_point = {p.reference_x_m, p.reference_y_m, p.reference_z_m},
            .refresh = p.refresh,
            .refresh_frames = p.refresh_frames,
            .refresh_ms = p.refresh_ms,
            .refresh_distance_m = p.refresh_distance_m,
            .mutual = p.mutual,
            .refractor_size = 16};
  }
  distance_impostors::LookupSettings lookup() const {
    return {.parallax = static_cast<distance_impostors::Parallax>(parameters_.parallax),
            .search = {},
            .bare = false,
            .bounces = 1,
            .internal = 0,
            .proxy_radius_m = parameters_.proxy_radius_m};
  }

  Parameters parameters_;
  CubeLayers layers_ = CubeLayers::geometry;
  distance_impostors::Localized localized_{"environment_map"};
};

}  // namespace

const ParameterTable& table() {
  return parameter_table<Parameters>();
}
std::unique_ptr<Technique> make() {
  return std::make_unique<EnvironmentMap>();
}

}  // namespace pellucid::environment_map
