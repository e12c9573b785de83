#include "algorithms/translucent_relief/transfer.hpp"

#include <cstddef>
#include <vector>

#include "algorithms/raster/transfer_cache.hpp"
#include "algorithms/scene/files/cache_file.hpp"

namespace pellucid::translucent_relief {

void Transfer::update(const Relief& relief) {
  if (relief.scattering == scattering_ && relief.absorption == absorption_ && relief.anisotropy == anisotropy_) return;
  scattering_ = relief.scattering;
  absorption_ = relief.absorption;
  anisotropy_ = relief.anisotropy;
  constexpr auto kEntries = static_cast<std::size_t>(scattering::TransferTable::kEntries);
  // A row a channel: sharp, f_t, θ̄, c_t; and one of the three c_r.
  std::vector<float> texels(4 * kEntries * 4, 0.0F);
  for (int c = 0; c < 3; ++c) {
    const double extinction = static_cast<double>(relief.scattering[c]) + static_cast<double>(relief.absorption[c]);
    const double albedo = extinction > 0.0 ? static_cast<double>(relief.scattering[c]) / extinction : 0.0;
    const scattering::TransferTable table =
        transfer_table({static_cast<double>(relief.anisotropy), albedo}, scattering::TransferModel::unscattered,
                       cache_folder("transfer_functions"));
    for (std::size_t i = 0; i < kEntries; ++i) {
      const scattering::TransferFit& fit = table.entries[i];
      float* texel = &texels[4 * (static_cast<std::size_t>(c) * kEntries + i)];
      texel[0] = static_cast<float>(fit.sharp);
      texel[1] = static_cast<float>(fit.f_t);
      texel[2] = static_cast<float>(fit.theta_bar);
      texel[3] = static_cast<float>(fit.c_t);
      texels[4 * (3 * kEntries + i) + static_cast<std::size_t>(c)] = static_cast<float>(fit.c_r);
    }
  }
  table_ = gl::Texture::make_2d("relief transfer", gl::Format::rgba32f, scattering::TransferTable::kEntries, 4);
  table_.upload(texels);
}

void Transfer::bind(const Relief& relief, const gl::Program& program) const {
  table_.bind(15);
  program.set("extinction", relief.scattering + relief.absorption);
}

}  // namespace pellucid::translucent_relief
