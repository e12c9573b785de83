#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/reference/photons/photons.hpp"

namespace pellucid {

/// Irradiance from photons that have landed, by a kernel of fixed radius: Σ Φ k(d), with
/// k = 2/(πr²)·(1 − d²/r²) over the distance d in the surface's plane, whose integral over a plane is 1. So no energy
/// is made or lost on flat surfaces but near their edges, where the kernel reaches beyond; caustics are blurred by it.
class PhotonMap {
 public:
  PhotonMap(std::vector<Deposit> deposits, double radius_m);

  struct Irradiance {
    glm::dvec3 mean{0.0};
    glm::dvec3 variance{0.0};  ///< of the estimate, by the photons' number: Σ (Φ k)²
  };
  /// On the side of a surface that `face` (unit) points to.
  Irradiance at(const glm::dvec3& point, const glm::dvec3& face) const;

  double radius_m() const { return radius_m_; }

 private:
  glm::ivec3 cell_of(const glm::dvec3& point) const;
  std::size_t bucket_of(const glm::ivec3& cell) const;

  double radius_m_;
  std::vector<Deposit> deposits_;        // sorted by bucket
  std::vector<std::uint32_t> begin_of_;  // by bucket, and the end
};

}  // namespace pellucid
