#include "sweeps/measure/errors_by_class.hpp"

#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

#include <nlohmann/json.hpp>

namespace pellucid::sweeps {

void put_errors_by_class(nlohmann::json& row, const NativeMap& map, const Image& flip) {
  if (map.classes.empty()) return;
  assert(flip.width == map.values.width && flip.height == map.values.height && flip.channels == 1);
  std::vector<double> sums(map.classes.size(), 0);
  std::vector<std::size_t> counts(map.classes.size(), 0);
  double all = 0;
  for (std::size_t i = 0; i < flip.pixels.size(); ++i) {
    const float of = map.values.pixels[i];
    if (!std::isfinite(of)) continue;
    const auto c = static_cast<std::size_t>(of);
    assert(c < sums.size());
    const double error = static_cast<double>(flip.pixels[i]);
    sums[c] += error;
    all += error;
    ++counts[c];
  }
  for (std::size_t c = 0; c < sums.size(); ++c) {
    if (counts[c] == 0) continue;
    row["flip_mean_" + map.classes[c]] = sums[c] / static_cast<double>(counts[c]);
    if (all > 0) row["flip_share_" + map.classes[c]] = sums[c] / all;
  }
}

}  // namespace pellucid::sweeps
