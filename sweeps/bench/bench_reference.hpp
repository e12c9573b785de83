#pragma once

#include <optional>
#include <vector>

#include "algorithms/reference/reference.hpp"
#include "sweeps/bench/bench.hpp"

namespace pellucid::sweeps {

/// Traces the picture that a frame approximates and keeps the times.
class ReferenceTracer {
 public:
  /// Keeps the addresses of scene and camera. In `options`, `samples` is taken as 1 and caustics are left out.
  ReferenceTracer(const Scene&, const Camera&, SurfaceOptions options);

  /// One picture. Throws what trace_surfaces() does.
  void trace();
  void forget() { trace_ms_.clear(); }  ///< the pictures so far, which only warmed up

  /// `method_ms`: `block` frames for each picture, drawn next to it.
  BenchReference against(const std::vector<double>& method_ms, int block) const;

 private:
  const Scene& scene_;
  const Camera& camera_;
  SurfaceOptions options_;
  std::vector<double> trace_ms_, build_ms_;
  double rays_per_pixel_ = 0;
};

}  // namespace pellucid::sweeps
