#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "algorithms/local_cube_maps/dynamic_objects.hpp"
#include "algorithms/local_cube_maps/hit_errors.hpp"
#include "algorithms/technique.hpp"

namespace pellucid::local_cube_maps {

/// A frame with local cube maps (Szirmay-Kalos et al. 2005, Sec. 6): first the maps that are due, then the opaque
/// objects, which the technique draws itself, then the interface objects.
class MapFrame {
 public:
  explicit MapFrame(const char* technique) : technique_(technique) {}

  /// Tells warnings on the standard error.
  void prepare(const Scene&, const MapSettings&, const LookupSettings&);
  /// Draws the maps that are due; returns the indices of their objects.
  std::vector<std::size_t> draw_maps(const Scene&, ForwardPass&, gl::PassTimer&, const MapSettings&,
                                     const LookupSettings&);
  /// The interface objects, behind what the target's depth holds.
  void draw_objects(const Scene&, const Camera&, ForwardPass&, const Target&, gl::PassTimer&, const MapSettings&,
                    const LookupSettings&);

  const DynamicObjects& objects() const { return objects_; }
  /// The errors of the last frame; `warnings` are told with the objects' own.
  void native_errors(const std::vector<std::string>& warnings, nlohmann::json&) const;
  std::vector<NativeMap> native_maps() const;
  std::string reload_shaders() { return objects_.reload_shaders(); }

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
  std::optional<Frame> frame_;
};

}  // namespace pellucid::local_cube_maps
