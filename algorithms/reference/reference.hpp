#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "algorithms/scene/image.hpp"
#include "algorithms/scene/scene.hpp"

/// Ground truth on the CPU: one tracer (Embree, TBB) that grows with the papers. It shades as the forward pass does and
/// integrates the medium in float64.
namespace pellucid {

/// Surfaces as seen at each pixel centre, rows from the top: radiance, and the distance from the eye along the pixel's
/// ray [m], infinite where nothing is hit.
struct SurfaceLayer {
  Image radiance;                  ///< RGB
  std::vector<double> distance_m;  ///< one per pixel
};

/// What shading needs of the surface at each pixel centre, rows from the top, as a rasteriser gives it.
struct SurfacePoints {
  Image albedo;                    ///< RGB, vertex colours and tints applied
  Image normal;                    ///< unit, world, turned to the viewer; zero where nothing is hit
  Image emission;                  ///< RGB
  std::vector<double> distance_m;  ///< one per pixel, infinite where nothing is hit
};

/// Shades them with exact shadows (Embree rays to the lights that cast them) and the environment behind: the surfaces
/// of the raster pass without the error of its shadow maps.
SurfaceLayer shade_surfaces(const Scene&, const Camera&, const SurfacePoints&);

/// Traces the opaque surfaces and the environment behind them with Embree.
SurfaceLayer trace_surfaces(const Scene&, const Camera&);

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
  Image mask;   ///< one channel: 1 where the pixel's ray meets the volume before a surface
  /// A pixel's step error: |radiance(n) − radiance(n/2)| at its last doubling in its worst channel (0 where no steps
  /// are needed), plus the rounding of the result to the image's float32. The largest and the mean over the frame. The
  /// true error is smaller still, since it falls 64-fold with a doubling. A light that shines exactly along the ray is
  /// moved aside by 1e-7 of its distance for its shadow's sake; of a light in the medium on the ray itself the integral
  /// has no bound, and the pixel is then unconverged.
  double step_error_max = 0;
  double step_error_mean = 0;
  double unconverged_share = 0;  ///< pixels that reached max_steps above the tolerance
};

/// Integrates dL/dt = σ(t)·C(t)·T(t) in float64 from the near plane to `surfaces` and adds T times their radiance.
/// Taking the surfaces from the shared raster pass instead of trace_surfaces() makes silhouettes identical, so that an
/// error metric sees the medium alone; both are offered (`--surfaces rays|raster`).
Reference render_reference(const Scene&, const Camera&, const SurfaceLayer& surfaces, const ReferenceOptions& = {});

}  // namespace pellucid
