#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "algorithms/key_maps/environment_filter.hpp"

namespace pellucid::scattering {

struct KeyChainOptions {
  int face_size = 512;  ///< of the source that the paper would keep as level 0; a power of two
  double omega = 0.02;  ///< threshold of KeyWidths
  SphereFilter filter = SphereFilter::direct;
  bool operator==(const KeyChainOptions&) const = default;
};
inline constexpr int kLeastFace = 64, kMostFace = 1024;

/// Key maps as a texture keeps them: half precision, divided by `scale` where the environment is brighter than that
/// holds.
struct KeyChain {
  KeyWidths widths{2, 0.02};
  float scale = 1;
  glm::vec3 mean{0.0F};                              ///< of the whole environment, not divided
  std::vector<std::vector<std::uint16_t>> half_rgb;  ///< by level from 1 on
  double filter_s = 0;                               ///< what filtering took, also where it was read from a file
  std::size_t bytes() const;                         ///< of the RGBA16F texture
  /// The bytes that as many key maps at full resolution would take, as the paper compares them.
  std::size_t full_resolution_bytes() const;
};

/// Filtered, or read from `folder` where the same environment was filtered before; an empty path keeps no files.
/// InputError when `face_size` is no power of two in range, `omega` not in (0, 0.5], or the image no environment.
KeyChain key_chain(const Environment&, const KeyChainOptions&, const std::filesystem::path& folder,
                   const std::function<void(double share)>& progress = {});

}  // namespace pellucid::scattering
