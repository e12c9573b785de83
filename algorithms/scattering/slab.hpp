#pragma once

#include <memory>
#include <string_view>
#include <vector>

/// How a plane slab of a homogeneous scattering medium spreads a beam that arrives perpendicular to it: the transfer
/// functions of Chan and Wang 2005, Sec. 3.3 (references.bib: chan2005), by discrete ordinates (Chandrasekhar 1960,
/// references.bib: chandrasekhar1960). The slab has no interface of its own.
namespace pellucid::scattering {

/// A medium whose phase function is that of Henyey and Greenstein (references.bib: henyey1941).
struct SlabMedium {
  double anisotropy = 0;  ///< g′: the mean cosine of the scattering angle, in (−1, 1)
  double albedo = 1;      ///< ω0: the share of the extinction that is scattering, in [0, 1]
};

/// Henyey and Greenstein's phase function [1/sr]; its integral over the sphere is 1.
double henyey_greenstein(double cosine, double anisotropy);

/// The largest anisotropy in magnitude that the discrete ordinates are made for.
inline constexpr double kMaxAnisotropy = 0.9999;

/// Throws InputError that names the quantity and its range, after `owner` ("slab", "material 'ice'").
void check_anisotropy(double anisotropy, std::string_view owner);
void check_albedo(double albedo, std::string_view owner);
void check_depth(double depth, std::string_view owner);

/// The fate of a unit of perpendicular flux. Directions are given by the cosine to the slab's normal, in order from
/// straight on to grazing. Radiance is that of scattered light alone and does not depend on the azimuth.
struct SlabLight {
  double depth = 0;          ///< τ, the optical thickness
  double reflectance = 0;    ///< flux that comes back
  double transmittance = 1;  ///< flux that gets through, the unscattered part included
  double unscattered = 1;    ///< e^(−τ)
  /// The part of the transmitted flux that is scattered by angles too small for the ordinates and kept with the
  /// unscattered part in the solution: 0 to rounding up to an anisotropy of 0.95.
  double near_forward = 0;
  std::vector<double> cosine;        ///< μ > 0 of the ordinates; the first is 1
  std::vector<double> weight;        ///< of a quadrature of ∫ f(μ) dμ over [0, 1]
  std::vector<double> transmission;  ///< radiance [1/sr] that leaves the far side, by ordinate
  std::vector<double> reflection;    ///< radiance [1/sr] that leaves the near side
};

/// Solves slabs of one medium: the eigenvectors of the medium are found once, and each thickness costs two systems of
/// linear equations. An object may be asked from any thread.
class Slab {
 public:
  /// Throws InputError for a medium out of range. `ordinates` a hemisphere, 0: as many as the phase function needs.
  explicit Slab(const SlabMedium&, int ordinates = 0);
  ~Slab();
  Slab(Slab&&) noexcept;
  Slab& operator=(Slab&&) noexcept;

  const SlabMedium& medium() const { return medium_; }
  /// `depth` ≥ 0, finite; InputError otherwise.
  SlabLight light(double depth) const;

 private:
  struct Modes;
  SlabMedium medium_;
  std::unique_ptr<const Modes> modes_;
};

}  // namespace pellucid::scattering
