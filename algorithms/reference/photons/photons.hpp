#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/scene/scene.hpp"

/// Forward photon tracing: the light that reaches Lambertian surfaces by way of mirrors, metals and dielectrics. It
/// ends there; light that these surfaces scatter on is not followed. Lights that cast no shadow pass through all
/// objects and send no photons.
///
/// Each photon sets out for one optical object: evenly over the disc that its bounding sphere shows a directional
/// light, or over the cone in which a point or spot sees it, and counts if that object is the first that it meets. Its
/// tree of rays is the eye's (ray_tree.hpp), its weak branches end by Russian roulette, so that all sums are unbiased.
/// Photons come in independent batches, from whose spread the standard errors follow. Results depend on the seed, not
/// on the number of threads.
namespace pellucid {

/// A rectangle whose light map is asked for: the points origin + u·edge_u + v·edge_v with u, v ∈ [0, 1).
struct Receiver {
  std::string name;
  glm::dvec3 origin{0.0}, edge_u{1.0, 0.0, 0.0}, edge_v{0.0, 0.0, 1.0};
  int width = 64, height = 64;  ///< texels, in [1, 4096]
  int instance = -1;  ///< what reaches this instance alone counts; −1: any Lambertian surface in the rectangle
};

/// The rectangle of an instance's texture coordinates. InputError if they are missing, or the mesh is not flat, or they
/// are not an affine function of the place.
Receiver receiver_of(const Scene&, int instance, int width, int height);

struct PhotonOptions {
  std::uint64_t photons = std::uint64_t{1} << 20;  ///< for each light that casts shadows and each optical object
  int batches = 16;                                ///< at least 2
  std::uint32_t seed = 1;
  int reflections = 32;                  ///< as SurfaceOptions has it
  int depth = 64;                        ///< likewise
  double roulette = 0.02;                ///< branches of less weight end by chance
  std::function<void(double)> progress;  ///< share done, from any thread
};

/// Power [W], RGB, with the standard error of its estimate.
struct Power {
  glm::dvec3 mean{0.0}, standard_error{0.0};
};

struct LightMap {
  Receiver receiver;
  double texel_area_m2 = 0;
  std::vector<glm::dvec3> power_w;           ///< by texel, u fastest, from v = 0 up
  std::vector<glm::dvec3> standard_error_w;  ///< of each texel
  Power total;
  /// Irradiance [W/m²] of a texel.
  glm::dvec3 irradiance(int u, int v) const {
    return power_w[static_cast<std::size_t>(v) * static_cast<std::size_t>(receiver.width) +
                   static_cast<std::size_t>(u)] /
           texel_area_m2;
  }
};

/// Where a photon has come down.
struct Deposit {
  glm::vec3 position, face;  ///< face: unit, the triangle's normal on the side that the photon came from
  glm::vec3 power_w;
};

/// All that the lights send to optical objects is landed + escaped + absorbed + limited.
struct Photons {
  std::vector<LightMap> maps;      ///< one for each receiver
  std::vector<Power> on_instance;  ///< of all that landed, by instance
  Power sent;                      ///< meets an optical object first
  Power landed;                    ///< reaches Lambertian surfaces
  Power escaped;                   ///< leaves the scene
  double limited_share = 0;        ///< of what was sent: cut by `reflections` and `depth`, in the worst channel
  double lost_share = 0;           ///< left a dielectric unmet or not entered: it is open, or inside out
  std::vector<Deposit> deposits;   ///< if they were asked for, in a fixed order
  std::uint64_t photons = 0, rays = 0;
  double seconds = 0;
};

/// Traces the photons of all lights. `keep_deposits`: fill Photons::deposits. InputError for a receiver without area or
/// with too many texels.
Photons trace_photons(const Scene&, const std::vector<Receiver>&, const PhotonOptions& = {},
                      bool keep_deposits = false);

}  // namespace pellucid
