#pragma once

#include <cstddef>
#include <utility>
#include <vector>

/// Which widths of a Gaussian the levels of a chain of filtered cube maps have, and between which of them a width lies:
/// Chan and Wang 2005, Sec. 3.2 (references.bib: chan2005).
namespace pellucid::scattering {

/// The least standard deviation, in texels of the full resolution, of a Gaussian that is kept by one of `factor`
/// texels. The Gaussian has the height 1; its samples at the middles of the coarse texels are joined by straight lines,
/// and at no middle of a fine texel, wherever the peak lies, may these miss it by more than `omega` (0 < omega < 1).
/// The paper states the rule for two dimensions but not its definition; this is the one of one dimension, which its
/// Table 1 follows but for a constant factor. `factor` is a power of two, 2 or more.
double least_width(int factor, double omega);

/// The widths of a chain of cube maps whose source would have n × n texels a face: level l, from 1 to log2(n), has
/// n/2^l texels, the last one a single one, and level 0 is the unfiltered environment.
class KeyWidths {
 public:
  /// `face_size` a power of two from 2 on.
  KeyWidths(int face_size, double omega);
  /// Widths that were worked out before, by level from 0 on.
  explicit KeyWidths(std::vector<double> widths) : widths_(std::move(widths)) {}

  const std::vector<double>& widths() const { return widths_; }
  int levels() const { return static_cast<int>(widths_.size()) - 1; }  ///< filtered ones
  /// Standard deviation [rad]; 0 for level 0. A texel counts as π/(2n), as in the paper.
  double width(int level) const { return widths_[static_cast<std::size_t>(level)]; }
  /// The level, with a fraction, where a linear mix of the two levels around it has the variance of a Gaussian of this
  /// width [rad]; at most levels().
  double level(double width) const;

 private:
  std::vector<double> widths_;
};

}  // namespace pellucid::scattering
