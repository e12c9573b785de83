#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "algorithms/scene/images/image.hpp"

namespace pellucid::sweeps {

// FLIP (references.bib: andersson2020, andersson2021): the error that a viewer sees when alternating between two
// images, and its extension to scene-linear images by a sweep over exposures. Errors lie in [0, 1]; 0 is "no visible
// difference". Where the published tool differs from the papers (constants to nine digits, separable filters), this
// follows the tool.

/// Pixels per degree of visual angle of the published default: a 0.7 m wide display of 3840 pixels seen from 0.7 m.
inline constexpr double kDefaultPixelsPerDegree = 67.02064327658225;  // 0.7 * 3840 / 0.7 * pi / 180

/// The exposure compensations of HDR-FLIP, in stops, evenly spaced from start to stop, both included.
struct Exposures {
  double start = 0;
  double stop = 0;
  int count = 0;
  double at(int i) const { return count < 2 ? start : start + (stop - start) * i / (count - 1); }
  bool operator==(const Exposures&) const = default;
};

/// The automatic exposures of HDR-FLIP: the brightest pixel of `reference` and its median one are brought to 0.85 by
/// the ACES curve; one exposure per stop between them, at least two. The median of an even number of pixels is the
/// upper one. Where the publication leaves it undefined: if half of the pixels are black, the median is that of the
/// others; a black reference gives {0, 0, 2}.
Exposures automatic_exposures(const Image& reference);

struct FlipOptions {
  double pixels_per_degree = kDefaultPixelsPerDegree;  ///< in [1, 1000]
  /// The perceived reference is kept for every exposure up to this size, and computed again for each test
  /// beyond it. A 720x540 frame takes 7.8 MB an exposure.
  std::size_t largest_cache_bytes = std::size_t{1} << 30;
};

/// All of FLIP that depends on the reference only, computed once for all of its tests. Immutable, and safe to use from
/// several threads.
class FlipReference {
 public:
  /// LDR-FLIP. `reference` holds sRGB-encoded values; they are clamped to [0, 1], as the metric is defined there only.
  static FlipReference display_encoded(const Image& reference, const FlipOptions& = {});
  /// HDR-FLIP. `reference` holds scene-linear Rec. 709 radiance; negative values count as 0. `exposures` must have a
  /// count of at least 1, finite stops, and start <= stop.
  static FlipReference scene_linear(const Image& reference, const Exposures& exposures, const FlipOptions& = {});
  FlipReference(FlipReference&&) noexcept;
  FlipReference& operator=(FlipReference&&) noexcept;
  ~FlipReference();

  /// The map of errors: one channel, the size of the reference, each in [0, 1]. For HDR the largest over the exposures.
  /// Throws InputError when the sizes differ or a channel is not finite.
  Image map(const Image& test) const;
  /// The exposures in use; the count is 0 for LDR-FLIP.
  const Exposures& exposures() const;

 private:
  struct State;
  explicit FlipReference(std::unique_ptr<State>);
  std::unique_ptr<State> state_;
};

/// The pooled statistics that the published tool prints. A weighted percentile p is the
/// smallest error e such that the errors up to e sum to more than p of the sum of all; it is 0 when every error is 0.
struct FlipStatistics {
  double mean = 0;
  double weighted_median = 0;
  double weighted_q1 = 0;
  double weighted_q3 = 0;
  double min = 0;
  double max = 0;
};
/// Throws InputError for an empty span.
FlipStatistics pool(std::span<const float> errors);

/// Colours a one-channel map of errors in [0, 1] from black by purple and orange to pale yellow, lightness rising
/// evenly (sRGB-encoded, for write_png).
Image error_colors(const Image& errors);

}  // namespace pellucid::sweeps
