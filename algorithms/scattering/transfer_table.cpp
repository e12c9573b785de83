#include "algorithms/scattering/transfer_table.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

#include <tbb/parallel_for.h>

namespace pellucid::scattering {

TransferTable::TransferTable(const SlabMedium& medium, TransferModel model) : entries(kEntries) {
  const Slab slab(medium);
  tbb::parallel_for(0, kEntries, [&](int i) {
    // The last entry would be endless; a slab this thick differs from it by less than a half-precision texture tells.
    const double x = std::min(static_cast<double>(i) / (kEntries - 1), 1 - 1e-5);
    entries[static_cast<std::size_t>(i)] = fit_transfer(slab.light(kHalfDepth * x / (1 - x)), model);
  });
}

TransferFit TransferTable::at(double depth) const {
  assert(depth >= 0);
  const double place = (kEntries - 1) * depth / (depth + kHalfDepth);
  const auto i = static_cast<std::size_t>(std::min(std::floor(place), double{kEntries - 2}));
  const double t = place - static_cast<double>(i);
  const TransferFit &a = entries[i], &b = entries[i + 1];
  const auto mix = [t](double x, double y) { return x + t * (y - x); };
  return {mix(a.sharp, b.sharp), mix(a.f_t, b.f_t),         mix(a.theta_bar, b.theta_bar),
          mix(a.f_2, b.f_2),     mix(a.theta_2, b.theta_2), mix(a.c_t, b.c_t),
          mix(a.c_r, b.c_r),     mix(a.rms, b.rms)};
}

}  // namespace pellucid::scattering
