#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "algorithms/local_cube_maps/dynamic_objects.hpp"
#include "algorithms/reference/interfaces.hpp"
#include "algorithms/technique.hpp"

namespace pellucid::local_cube_maps {

/// Why a ray's hit is right or wrong.
enum class HitClass {
  right,          ///< in the direction of the true one, as seen from the reference point, to kRightTexels
  other_surface,  ///< on another surface of the ray: the search has converged, away from the true hit's plane
  hidden,         ///< the reference point does not see the true hit, so that the map lacks it
  unconverged     ///< on no surface
};
/// The extent of a texel in the middle of a face, where texels are widest: a point farther off has another texel's
/// light.
inline constexpr double kRightTexels = 2;
/// A search has converged where |l| / |l'| is no farther off 1 than this; from the plane of the true hit its point is
/// off by more than twice this share of the distance, where it is on another surface.
inline constexpr double kConverged = 0.01;

/// By what a hit is classified.
struct HitPlace {
  double direction_error_deg = 0;  ///< seen from the reference point
  double ratio = 1;                ///< |l| / |l'|
  double off_plane = 0;            ///< |n · (l − q)| of the true hit q with the normal n, over q's distance
  bool hidden = false;
};
HitClass classify(const HitPlace&, int cube_size);

struct RayReport;

/// Where the objects' rays are taken to hit beside where they hit (Embree), for each pixel that shows an object.
class HitErrors {
 public:
  HitErrors(DynamicObjects&, const Scene&, const ForwardPass&, const Camera&, const MapSettings&,
            const LookupSettings&);

  /// `hit_error_m_mean`, `_median`, `_q95`, `_max`: between the two points;
  /// `direction_error_deg_…`: between their directions from the reference point, which choose the texel; with
  /// `_median_seen` and `_q95_seen` of the hits that the reference point sees;
  /// `unconverged_share`: of the hits with |l| / |l'| more than 1 % off 1;
  /// `hidden_share`: of the true hits that the reference point does not see;
  /// `hits_C_share` for each class C of HitClass, which sum to one, `hits_C_error_m_mean`, and `hits_C_error_share`: of
  /// the sum of all hits' errors;
  /// `exit_error_diagonals_…`, `exit_direction_error_deg_…`: of refracted rays, where they leave the object for the
  /// first time, in diagonals of the object, and in which direction, beside the exact way through it; `escaped_share`:
  /// of the rays that hit nothing, which all of these leave out.
  void write(nlohmann::json& out) const;
  /// The same by pixel: `hit_error_m`, `direction_error_deg`, `hit_class`.
  std::vector<NativeMap> maps() && { return std::move(maps_); }

 private:
  void add(const DynamicObjects::Object&, const InterfaceTracer&, const Camera&, const RayReport&);
  void add_exit(const InterfaceTracer&, const Camera&, std::size_t pixel, int instance, const glm::dvec3& from,
                const glm::dvec3& R);

  RayLookup lookup_kind_;
  bool refracts_twice_;
  int cube_size_;
  std::vector<NativeMap> maps_;
  std::vector<double> exit_diagonals_, exit_deg_;
  std::size_t pixels_ = 0, rays_ = 0, escaped_ = 0, hidden_ = 0, unconverged_ = 0;
  std::vector<double> seen_deg_;
};

}  // namespace pellucid::local_cube_maps
