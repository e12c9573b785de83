#pragma once

#include <utility>
#include <vector>

#include "algorithms/scattering/transfer_fit.hpp"

namespace pellucid::scattering {

/// The fits of one medium over all thicknesses, to be interpolated: Chan and Wang 2005, Sec. 4, keep them in a 1D
/// texture by ray depth. Entry i of n stands for τ = kHalfDepth · x / (1 − x) with x = i / (n − 1), so that the last
/// one is of an endless thickness.
struct TransferTable {
  static constexpr double kHalfDepth = 2;  ///< τ in the middle of the table
  static constexpr int kEntries = 128;

  std::vector<TransferFit> entries;

  /// Throws InputError for a medium out of range. Takes some tens of milliseconds.
  TransferTable(const SlabMedium&, TransferModel);
  explicit TransferTable(std::vector<TransferFit> known) : entries(std::move(known)) {}
  /// Interpolated linearly, as a texture would be; `depth` ≥ 0.
  TransferFit at(double depth) const;
};

}  // namespace pellucid::scattering
