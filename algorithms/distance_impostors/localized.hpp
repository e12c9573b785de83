#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "algorithms/distance_impostors/caustics.hpp"
#include "algorithms/distance_impostors/dynamic_objects.hpp"
#include "algorithms/distance_impostors/native_errors.hpp"
#include "algorithms/technique.hpp"

namespace pellucid::distance_impostors {

/// The frame of distance_impostors and of environment_map, which differ in their settings alone.
class Localized {
 public:
  explicit Localized(const char* technique) : technique_(technique) {}

  void prepare(const Scene&, const MapSettings&, const LookupSettings&, const CausticSettings& = {});
  void render(const Scene&, const Camera&, ForwardPass&, const Target&, gl::PassTimer&, const MapSettings&,
              const LookupSettings&);
  void native_errors(nlohmann::json&) const;
  std::vector<NativeMap> native_maps() const;
  std::string reload_shaders() { return objects_.reload_shaders() + caustics_.reload_shaders(); }

 private:
  HitErrors hit_errors() const;

  // The last frame, for native_errors().
  struct Frame {
    const Scene* scene;
    const ForwardPass* forward;
    Camera camera;
    MapSettings maps;
    LookupSettings lookup;
  };
  const char* technique_;
  mutable DynamicObjects objects_;
  CausticSettings caustic_settings_;
  Caustics caustics_;
  std::optional<Frame> frame_;
};

}  // namespace pellucid::distance_impostors
