#pragma once

#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "algorithms/reference/relief/relief_tracer.hpp"
#include "algorithms/technique.hpp"

namespace pellucid::translucent_relief {

/// The result of a frame's view rays, four floats per pixel each, rows from the bottom.
struct SearchReport {
  std::vector<float> start;  ///< the mesh's uv; 0: nothing met, 1: the solid, 2: the medium; distance from the mesh [m]
  std::vector<float> ray;    ///< direction in the frame, and 1 where the pixel shows the mesh; step [m]
  std::vector<float> scale;  ///< metres over u and v; heights asked for
  std::vector<float> light;  ///< of the first light: direction in the frame, share that reaches the hit
};

/// The searches of a frame beside exact rays against the same height fields, by pixel.
class SearchErrors {
 public:
  SearchErrors(int width, int height);
  /// The pixels of one instance.
  void add(const SearchReport&, const ReliefTracer&);
  /// `first_hit_error_m_mean` …, of the rays that found the surface that they meet; `missed_share`: rays that stepped
  /// through a feature, to end more than one step of the search behind it, or nowhere; `occlusion_error_mean` …: of the
  /// first light's share at the hit; `heights_taken_mean` …; `relief_pixels`.
  void write(nlohmann::json& out) const;
  std::vector<NativeMap> maps() && { return std::move(maps_); }

 private:
  std::vector<NativeMap> maps_;
};

}  // namespace pellucid::translucent_relief
