#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/reference/ray_tree.hpp"
#include "algorithms/reference/reference.hpp"
#include "algorithms/scene/files/cache_file.hpp"

/// A picture of which some samples a pixel are done.
namespace pellucid {

/// Mean and spread of a pixel's samples (Welford).
class SampleMean {
 public:
  void add(const glm::dvec3& value) {
    ++count_;
    const glm::dvec3 off = value - mean_;
    mean_ += off / static_cast<double>(count_);
    squares_ += off * (value - mean_);
  }
  const glm::dvec3& value() const { return mean_; }
  /// In the worst channel.
  double standard_error() const {
    if (count_ < 2) return 0.0;
    return std::sqrt(worst(squares_) / (static_cast<double>(count_ - 1) * static_cast<double>(count_)));
  }

 private:
  std::int64_t count_ = 0;
  glm::dvec3 mean_{0.0}, squares_{0.0};
};

struct PixelSum {
  SampleMean radiance;
  glm::dvec3 caustic_error{0.0};
  double cut_weight = 0;
  std::int64_t met_optical = 0;  ///< samples that meet an optical object first
};

/// Kept in $PELLUCID_CACHE/paths while it grows, and when it is done, if it takes long: a picture that is asked for
/// again goes on where it was stopped. The samples are the same either way.
class PartialPicture {
 public:
  /// Takes up what is kept of the same scene, camera and options. Nothing is kept unless `lasting`, nor of a scene that
  /// was not loaded from a file, nor with caustics.
  PartialPicture(const Scene&, const Camera&, const SurfaceOptions&, bool lasting);

  std::vector<PixelSum> pixels;  ///< rows from the top
  TreeTally tally;
  std::int64_t samples = 0;  ///< a pixel, done
  double trace_s = 0;        ///< what they took

  /// After more samples; `done` when they are the last. Writes now and then.
  void advance(bool done);

 private:
  CacheFile file_;  // without a path: nothing is kept
  std::chrono::steady_clock::time_point last_, written_;
  double write_s_ = 0;  // what the last writing took
};

}  // namespace pellucid
