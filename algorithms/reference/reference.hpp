#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "algorithms/scene/images/image.hpp"
#include "algorithms/scene/scene.hpp"

/// Ground truth on the CPU: one tracer (Embree, TBB) that grows with the papers. It shades as the forward pass does and
/// integrates the medium in float64.
namespace pellucid {

/// True if an instance of the scene is a mirror, a metal or a dielectric, or carries a relief.
bool has_interfaces(const Scene&);

/// How trace_surfaces() samples pixels and follows light at interfaces.
///
/// At a mirror or metal one ray goes on, at a dielectric two: Fresnel's share is reflected, the rest refracted (Snell),
/// and Beer–Lambert absorption acts over each path inside. Every branch of the tree ends at a Lambertian surface, which
/// is lit directly with exact shadows, or in the environment. All objects cast shadows, dielectrics too: what they let
/// through comes as `caustics`, or not at all. Normals are interpolated as in the raster pass; where such a normal
/// would send a ray to the wrong side of its triangle, it is bent towards the triangle's just so far that it does not.
///
/// Dielectrics are closed solids, disjoint or nested; a nested one's `ior` is relative to the one around it, and the
/// innermost alone absorbs. Where solids overlap, each boundary acts as if nested in the order in which the ray
/// enters. The eye may be inside of some.
struct SurfaceOptions {
  int samples = 1;  ///< a pixel: 1 is its centre, as the raster pass sees it; more are stratified over its square
  std::uint32_t seed = 1;  ///< of their places
  /// Inside dielectrics, between entering the outermost and leaving it: 0, 1, … as the geocube's parameter of that
  /// name. Light that needs more is dark, total reflection included.
  int reflections = 32;
  int depth = 64;                ///< interfaces along a path
  double cut = 1e-4;             ///< a branch of less weight is left out
  bool entry_reflection = true;  ///< follow what is reflected at the outside of dielectrics
  bool both_sides = true;        ///< false: refraction at the front alone; rays leave unbent, unreflected
  bool refract_light = false;    ///< at reliefs' media; the paper's light goes straight (relief_tracer.hpp)
  /// Light that reaches Lambertian surfaces through objects, from photons (photons.hpp) by a density estimate.
  bool caustics = false;
  std::uint64_t photons = std::uint64_t{1} << 20;  ///< for each light that casts shadows and each optical object
  double caustic_radius_m = 0;           ///< of the estimate's kernel; 0: 1 % of the largest optical object's radius
  std::function<void(double)> progress;  ///< share done, from any thread
};

/// The cost of trace_surfaces(), and its distance from the truth. "Weight" is a share of the light that a pixel shows,
/// in the channel where it is largest: times the scene's largest radiance it bounds the error.
struct SurfaceStatistics {
  int samples = 1;
  std::int64_t kept_samples = 0;   ///< of these, from an earlier run of the same picture (`PartialPicture`)
  double standard_error_max = 0;   ///< of a pixel's worst channel; an upper bound, since strata only lessen it. 0 at
  double standard_error_mean = 0;  ///< one sample, which is the truth at the pixel's centre
  double cut_weight_max = 0;       ///< of branches left out by `cut` and `depth`: of a pixel, and the mean of all
  double cut_weight_mean = 0;
  double limited_weight_mean = 0;  ///< of light that `reflections`, `entry_reflection` leave out by definition
  double lost_weight_mean = 0;     ///< of rays that left a dielectric unmet or not entered: it is open, or inside out
  double caustic_standard_error_max = 0;  ///< by the number of photons
  double caustic_standard_error_mean = 0;
  std::uint64_t rays = 0;  ///< shadow rays included
  double build_s = 0;      ///< Embree's hierarchy
  double photons_s = 0;
  double trace_s = 0;  ///< the picture alone
  double rays_per_s() const { return trace_s > 0 ? static_cast<double>(rays) / trace_s : 0; }
};

/// Surfaces as seen at each pixel, rows from the top: radiance, and the distance from the eye along the ray through the
/// pixel's centre [m], infinite where nothing is hit.
struct SurfaceLayer {
  Image radiance;                  ///< RGB
  std::vector<double> distance_m;  ///< one per pixel
  Image optical;  ///< one channel: share of the pixel's rays that meet an optical object first; or empty
  SurfaceStatistics statistics{};
};

/// The surface at each pixel centre as shading needs it, rows from the top, as a rasteriser gives it.
struct SurfacePoints {
  Image albedo;                    ///< RGB, vertex colours and tints applied
  Image normal;                    ///< unit, world, turned to the viewer; zero where nothing is hit
  Image emission;                  ///< RGB
  std::vector<double> distance_m;  ///< one per pixel, infinite where nothing is hit
};

/// Shades them with exact shadows (Embree rays to the lights that cast them) and the environment behind: the surfaces
/// of the raster pass without the error of its shadow maps. InputError if the scene has interfaces, which that pass
/// does not draw.
SurfaceLayer shade_surfaces(const Scene&, const Camera&, const SurfacePoints&);

/// Traces the objects and the environment behind them with Embree. InputError if the scene has interfaces and a volume
/// (the medium is integrated along the eye's rays alone), or a volume and `samples` above 1.
SurfaceLayer trace_surfaces(const Scene&, const Camera&, const SurfaceOptions& = {});

/// The density is a cubic of the distance between the planes of voxel centres that a ray crosses, and the extinction
/// between the kinks of a transfer function, so the optical depth is exact. The edges of shadows on the ray and of
/// spots' cones are solved for, not stepped to, so that no shadow is too thin to count. Between all these cuts the
/// integrand is smooth: where the source radiance is constant (ambient and directional light, one albedo) it has a
/// closed form; the other parts are cut into equal steps (three-point Gauss–Legendre quadrature), doubled where they
/// still matter.
struct ReferenceOptions {
  /// Doubling ends when the spans' changes sum to less than this in the pixel's worst channel [radiance].
  double tolerance = 1e-4;
  /// Along a ray, at least, before the first doubling; each part has one. They guard against a change that is small by
  /// chance, and need not find anything.
  int min_steps = 64;
  /// Along a ray; a pixel that needs more is counted as unconverged. One doubling is always done.
  int max_steps = 8192;
  std::function<void(double)> progress;  ///< share done, from any thread
};

struct Reference {
  Image image;  ///< RGBA; alpha is the medium's transmittance
  /// One channel: 1 where the pixel's ray meets the volume before a surface; without a volume, the share of the pixel's
  /// rays that meet an optical object first.
  Image mask;
  /// A pixel's step error: |radiance(n) − radiance(n/2)| at its last doubling in its worst channel (0 where no steps
  /// are needed), plus the rounding of the result to the image's float32. The largest and the mean over the frame. The
  /// true error is smaller still, since it falls 64-fold with a doubling. A light that shines exactly along the ray is
  /// moved aside by 1e-7 of its distance for its shadow's sake; of a light in the medium on the ray itself the integral
  /// has no bound, and the pixel is then unconverged.
  double step_error_max = 0;
  double step_error_mean = 0;
  double unconverged_share = 0;  ///< pixels that reached max_steps above the tolerance
  SurfaceStatistics surfaces{};  ///< as given with them
};

/// Integrates dL/dt = σ(t)·C(t)·T(t) in float64 from the near plane to `surfaces` and adds T times their radiance.
/// Taking the surfaces from the shared raster pass instead of trace_surfaces() makes silhouettes identical, so that an
/// error metric sees the medium alone; both are offered (`--surfaces rays|raster`).
Reference render_reference(const Scene&, const Camera&, const SurfaceLayer& surfaces, const ReferenceOptions& = {});

}  // namespace pellucid
