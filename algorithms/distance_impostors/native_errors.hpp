#pragma once

#include <nlohmann/json_fwd.hpp>

#include "algorithms/distance_impostors/caustics.hpp"
#include "algorithms/distance_impostors/dynamic_objects.hpp"

namespace pellucid::distance_impostors {

/// Where the objects' rays are taken to hit beside where they hit (Embree), for each pixel that shows an object:
/// `hit_error_m_mean`, `hit_error_m_median`, `hit_error_m_q95`: between the two points;
/// `direction_error_deg_…`: between their directions from the reference point, which choose the texel;
/// `unconverged_share`: of the hits with |l| / |l'| more than 1 % off 1;
/// `hidden_share`: of the true hits that the reference point does not see; `direction_error_deg_median_seen`: of the
/// others;
/// `exit_error_diagonals_…`, `exit_direction_error_deg_…`: of refracted rays, where they leave the object for the first
/// time, in diagonals of the object, and in which direction, beside the exact way through it;
/// `escaped_share`: of the rays that hit nothing, which all of these leave out.
void compare_hits(DynamicObjects&, const Scene&, const ForwardPass&, const Camera&, const MapSettings&,
                  const LookupSettings&, nlohmann::json& out);

/// The light in the light maps beside what photon tracing lands on opaque surfaces (mean of the channels):
/// `caustic_landed_w`, `caustic_reference_w` with its `caustic_reference_standard_error_w`, and the
/// `caustic_energy_ratio` of the first two.
void compare_caustics(const Caustics&, const Scene&, nlohmann::json& out);

}  // namespace pellucid::distance_impostors
