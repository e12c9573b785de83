#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "algorithms/distance_impostors/receivers.hpp"
#include "algorithms/local_cube_maps/dynamic_objects.hpp"
#include "algorithms/raster/forward_pass.hpp"

namespace pellucid::distance_impostors {

using local_cube_maps::DynamicObjects;
using local_cube_maps::LookupSettings;
using local_cube_maps::MapSettings;

struct CausticSettings {
  bool enabled = false;
  int map_size = 64;         ///< photons along a side of the map that a light sees an object through
  int light_map_size = 256;  ///< of each receiver
  float sigma_texels = 1;    ///< of a splat
  bool every_frame = true;   ///< else when light, objects or maps changed
};

/// Light that mirrors, metals and dielectrics send on to opaque objects (Szirmay-Kalos et al. 2005, Sec. 5). From each
/// light that casts shadows an object is drawn into a photon map: each fragment follows its share of the light through
/// the object and by the distance impostor to the hit, where a cube map of texture coordinates tells the receiver and
/// the place on it. Each photon is then splatted as a Gaussian into the receiver's light map. Photons that leave an
/// object after another reflection inside it have a map of their own, so that no light is lost.
class Caustics {
 public:
  /// Finds the receivers.
  void prepare(const Scene&, const CausticSettings&, const MapSettings&, const DynamicObjects&);

  /// After the maps of `due` have been drawn: their maps of places, then photons and light maps, then the light in
  /// these maps.
  void update(const Scene&, const ForwardPass&, const DynamicObjects&, const MapSettings&, const LookupSettings&,
              const std::vector<std::size_t>& due);
  /// Adds the light to the frame's opaque objects.
  void draw(const Scene&, const Camera&);

  /// Power [W] that lies in the light maps, the mean of the channels.
  double landed_w() const;
  const gl::Texture& light_maps() const { return light_maps_; }  ///< rgb: irradiance [W/m²]; a: power in the texel [W]
  /// Instances in the order of the light maps' layers.
  std::vector<int> receivers() const { return receivers_.instances(); }
  const std::vector<std::string>& warnings() const { return warnings_; }
  std::string reload_shaders();

 private:
  struct PhotonCamera {
    glm::mat4 world_to_clip{1.0F};
    glm::vec3 axis{0.0F};
    float texel = 0;  // side of a texel: on the plane at distance 1, or [m] of a directional light's
  };
  void draw_places(const Scene&, const DynamicObjects::Object&, std::size_t index, const MapSettings&);
  void add_light(const DynamicObjects::Object&, const MapSettings&);
  bool see(const Scene&, const Light&, const DynamicObjects::Object&, PhotonCamera&);
  void trace(const Scene&, const ForwardPass&, const DynamicObjects&, std::size_t index, const Light&,
             const LookupSettings&);
  void splat(int exits);
  const gl::Program& photon_program(const DynamicObjects&, SurfaceKind, const LookupSettings&);
  void warn(std::string text);

  CausticSettings settings_;
  Receivers receivers_;
  std::vector<gl::Texture> places_;  // one cube map for each object: u, v, receiver and part, area of the unit square
  std::vector<CubeTarget> place_targets_;
  gl::Texture photon_places_, photon_powers_, photon_depth_, light_maps_;
  std::vector<gl::Framebuffer> photon_framebuffers_;
  gl::Framebuffer light_map_framebuffer_;
  struct Compiled {
    gl::Defines defines;
    gl::Program program;
  };
  std::map<SurfaceKind, Compiled> photon_programs_;
  gl::Program place_program_, cube_light_program_, light_program_, splat_program_, depth_program_;
  gl::VertexArray points_;
  std::uint64_t revision_ = 0;
  bool traced_ = false;
  std::vector<std::string> warnings_;
};

/// The light in the light maps beside what photon tracing lands on opaque surfaces (mean of the channels):
/// `caustic_landed_w`, `caustic_reference_w` with its `caustic_reference_standard_error_w`, and the
/// `caustic_energy_ratio` of the first two.
void compare_caustics(const Caustics&, const Scene&, nlohmann::json& out);

}  // namespace pellucid::distance_impostors
