// Szirmay-Kalos et al. 2005 (references.bib: szirmaykalos2005).
#include "algorithms/distance_impostors/distance_impostors.hpp"

#include <string>
#include <vector>

#include "algorithms/distance_impostors/localized.hpp"

namespace pellucid::distance_impostors {
namespace {

class DistanceImpostors final : public Technique {
 public:
  ParameterRef parameters() override { return bind_parameters(parameters_); }
  void prepare(const Scene& scene) override {
    maps_ = map_settings(parameters_);
    localized_.prepare(scene, maps_, lookup_settings(parameters_), caustics());
  }
  void render(const Scene& scene, const Camera& camera, ForwardPass& forward, const Target& target,
              gl::PassTimer& timer) override {
    // The sources of the maps change with prepare() alone; the time at which they are drawn again changes freely.
    MapSettings maps = map_settings(parameters_);
    maps.layers = maps_.layers;
    localized_.render(scene, camera, forward, target, timer, maps, lookup_settings(parameters_));
  }
  void native_errors(nlohmann::json& out) const override { localized_.native_errors(out); }
  std::vector<NativeMap> native_maps() const override { return localized_.native_maps(); }
  std::string reload_shaders() override { return localized_.reload_shaders(); }

 private:
  CausticSettings caustics() const {
    const Parameters& p = parameters_;
    return {.enabled = p.caustics,
            .map_size = p.caustic_size,
            .light_map_size = p.light_map_size,
            .sigma_texels = p.splat_sigma,
            .every_frame = p.caustic_refresh == CausticRefresh::every_frame};
  }

  Parameters parameters_;
  MapSettings maps_;
  Localized localized_{"distance_impostors"};
};

}  // namespace

MapSettings map_settings(const Parameters& p) {
  return {.cube_size = p.cube_size,
          .format = p.cube_format,
          .store = p.distance,
          .layers = layers_of(p.cube_pass),
          .anchor = p.reference_point,
          .anchor_point = {p.reference_x_m, p.reference_y_m, p.reference_z_m},
          .refresh = p.refresh,
          .refresh_frames = p.refresh_frames,
          .refresh_ms = p.refresh_ms,
          .refresh_distance_m = p.refresh_distance_m,
          .mutual = p.mutual,
          .refractor_size = p.refractor_size};
}

LookupSettings lookup_settings(const Parameters& p) {
  return {.parallax = Parallax::impostor,
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
