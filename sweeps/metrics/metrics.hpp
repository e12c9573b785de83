#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "algorithms/scene/images/image.hpp"
#include "sweeps/metrics/flip.hpp"

namespace pellucid::sweeps {

// Image metrics of a test t against a reference r (references.bib: wang2004, rousselle2011, vogels2018). An image has 1
// (grey, used for R, G and B), 3 or 4 channels; alpha is not compared. Means go over the pixels and R, G, B.
//
//   mse     mean (t - r)^2
//   rmse    sqrt(mse)
//   relmse  mean (t - r)^2 / (r^2 + 0.01), after rousselle2011
//   mae     mean |t - r|
//   smape   mean |t - r| / (|t| + |r| + 0.01), after vogels2018
//   psnr    10 log10(peak^2 / mse), in dB
//   ssim    mean SSIM of the luma, after wang2004
//   flip    FLIP, pooled: mean, weighted median and quartiles, min, max (sweeps/metrics/flip.hpp)
//
// Scene-linear images (EXR): errors are of radiance; the peak of psnr is the largest R, G or B of the reference (1 if
// that is not above 0); ssim is of the image clamped to [0, 1] and sRGB-encoded; flip is HDR-FLIP. Display-encoded
// images (PNG): errors are of the encoded values in [0, 1]; the peak is 1; flip is LDR-FLIP.
//
// The luma is 0.2126 R' + 0.7152 G' + 0.0722 B'. SSIM uses an 11x11 Gaussian window of sigma 1.5, K1 = 0.01, K2 = 0.03,
// and averages over the windows that lie wholly inside the frame; a smaller frame is an error. The PSNR of identical
// images is infinite: +inf in ComparisonResult, null in JSON, "inf" in text.

/// The names that can be asked for, in the order of the output: flip, mse, rmse, relmse, mae, smape, psnr, ssim.
std::vector<std::string> metric_names();

/// A checked set of metric names, kept in the order of metric_names().
class MetricSet {
 public:
  /// All metrics.
  MetricSet();
  /// Throws InputError for an unknown name ("unknown metric 'flp'; did you mean 'flip'?") and for an empty list.
  explicit MetricSet(std::span<const std::string> names);

  bool has(std::string_view name) const;
  const std::vector<std::string>& names() const { return names_; }
  /// The names of the values that compare() gives, in its order: "flip_mean", …, "mse", and when `masked` the same
  /// again with the suffix "_mask".
  std::vector<std::string> columns(bool masked) const;

 private:
  std::vector<std::string> names_;
};

struct ComparisonOptions {
  MetricSet metrics{};
  bool display_encoded = false;          ///< ImageFile::display_encoded of both images
  bool keep_map = false;                 ///< fill ComparisonResult::flip_map, whether or not "flip" is in `metrics`
  FlipOptions flip{};                    ///< pixels per degree
  std::optional<Exposures> exposures{};  ///< scene-linear only; automatic_exposures(reference) when absent
};

struct ComparisonResult {
  /// In the order of MetricSet::columns; finite, but for psnr = +inf.
  std::vector<std::pair<std::string, double>> values;
  Image flip_map;  ///< one channel; empty unless keep_map

  /// Throws std::out_of_range for a name that is not there.
  double at(std::string_view name) const;
};

/// Writes each value into the object `row` under its name; an infinite one as null.
void put_values(nlohmann::json& row, const ComparisonResult&);

/// Marked pixels: those whose first channel is above 0.5.
struct Region {
  std::string suffix;  ///< of the names of its values: "_shadow"
  Image mask;
};

/// One reference, compared with many tests. Work on the reference alone is done once, HDR-FLIP's exposures
/// included, so all tests of a reference share them. Holds a copy of the reference; compare() may be called from
/// several threads.
class Comparison {
 public:
  /// `mask`, if not null, is a region with the suffix "_mask": the object. Statistics are given for the whole frame and
  /// for the pixels of each region; maps and windows always see the whole frame. Throws InputError: a pixel that is not
  /// finite (named, with the first one's place), channels other than 1, 3 or 4, a mask of another size or without any
  /// pixel, a frame too small for SSIM.
  Comparison(Image reference, const Image* mask = nullptr, ComparisonOptions = {});
  Comparison(Image reference, const std::vector<Region>& regions, ComparisonOptions);
  Comparison(Comparison&&) noexcept;
  Comparison& operator=(Comparison&&) noexcept;
  ~Comparison();

  /// Throws InputError when the sizes differ or a pixel is not finite.
  ComparisonResult compare(const Image& test) const;

  const Exposures* exposures() const;  ///< HDR-FLIP's; null when FLIP is not computed or is LDR
  bool masked() const;                 ///< there is a region "_mask"

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pellucid::sweeps
