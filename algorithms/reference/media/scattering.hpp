#pragma once

#include <cstddef>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/reference/media/light_path.hpp"
#include "algorithms/reference/media/medium_path.hpp"
#include "algorithms/reference/reference.hpp"
#include "algorithms/reference/shading.hpp"

/// Light that the medium adds along a ray: isotropic single scattering, ∫ σ C T dt with the source radiance
/// C = emission + albedo · (ambient + Σ V E / 4π).
namespace pellucid {

struct ScatteredLight {
  glm::dvec3 radiance{0.0};
  double transmittance = 1.0;
  double step_error = 0.0;  ///< change by the last doubling, as Reference has it
  bool converged = true;
};

/// The medium of a scene, ready for rays. Between the cuts of LightPath and MediumGrid the integrand is smooth. It has
/// a closed form where C is constant; elsewhere it takes Gauss–Legendre quadrature.
class Scattering {
 public:
  Scattering(const Scene&, const Volume&);
  Scattering(const Scattering&) = delete;
  Scattering& operator=(const Scattering&) = delete;

  const MediumGrid& grid() const { return grid_; }

  // A ray needs these for a while; they are kept between rays, since that spares allocations.
  struct Step;
  struct Scratch {
    Scratch();
    ~Scratch();
    LightPath::Scratch light_path;
    std::vector<LitPart> lit;
    std::vector<CellSpan> spans;
    std::vector<Step> steps;
  };
  /// Over the ray's part `inside` (from MediumGrid::clip()). `direction` unit.
  ScatteredLight along(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& inside,
                       const ReferenceOptions& options, Scratch& scratch) const;

 private:
  struct Ray {
    glm::dvec3 origin, direction;
  };
  bool constant_source(const CellSpan& span, unsigned lights) const;
  glm::dvec3 source(const CellSpan& span, double s, unsigned lights, const glm::dvec3& point) const;
  glm::dvec3 integrate(const Ray& ray, const CellSpan& span, const Step& step) const;
  void cut(const Ray& ray, const Interval& inside, Scratch& scratch, ScatteredLight& result) const;
  void refine(const Ray& ray, const ReferenceOptions& options, Scratch& scratch, ScatteredLight& result) const;

  Illumination light_;
  MediumGrid grid_;
  LightPath light_path_;
  glm::dvec3 emission_;
  bool in_light_space_;
  unsigned varying_lights_ = 0;  // bit i: the i-th light's E depends on the place
};

}  // namespace pellucid
