#include "sweeps/bench/bench_reference.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <utility>

namespace pellucid::sweeps {

ReferenceTracer::ReferenceTracer(const Scene& scene, const Camera& camera, SurfaceOptions options)
    : scene_(scene), camera_(camera), options_(std::move(options)) {
  options_.samples = 1;
  options_.caustics = false;
}

void ReferenceTracer::trace() {
  const SurfaceStatistics statistics = trace_surfaces(scene_, camera_, options_).statistics;
  trace_ms_.push_back(1e3 * statistics.trace_s);
  build_ms_.push_back(1e3 * statistics.build_s);
  rays_per_pixel_ = static_cast<double>(statistics.rays) / (static_cast<double>(camera_.width) * camera_.height);
}

BenchReference ReferenceTracer::against(const std::vector<double>& method_ms, int block) const {
  const auto frames = static_cast<std::size_t>(block);
  assert(block > 0 && !trace_ms_.empty() && method_ms.size() == frames * trace_ms_.size());
  // Each picture stands for as many samples as there are frames beside it.
  std::vector<double> traces;
  for (const double trace : trace_ms_)
    traces.insert(traces.end(), frames, trace);
  const auto ratio = block_ratio(traces, method_ms, {}, block);
  assert(ratio);  // every time is positive
  std::vector<double> builds = build_ms_;
  std::sort(builds.begin(), builds.end());
  return {.trace = summarise(trace_ms_),
          .build_ms = quantile(builds, 0.5),
          .ratio = *ratio,
          .rays_per_pixel = rays_per_pixel_,
          .depth = options_.depth,
          .reflections = options_.reflections};
}

}  // namespace pellucid::sweeps
