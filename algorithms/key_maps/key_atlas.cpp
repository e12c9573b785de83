#include "algorithms/key_maps/key_atlas.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/gtc/packing.hpp>

#include "gl/cube_faces.hpp"

namespace pellucid::scattering {
namespace {

using HalfTexel = std::array<std::uint16_t, 4>;

constexpr std::uint16_t kHalfOne = 0x3c00;

/// One map of the chain; texels as gl/cube_faces.hpp numbers them.
class HalfMap {
 public:
  HalfMap(const std::vector<std::uint16_t>& half_rgb, int size) : half_rgb_(half_rgb), size_(size) {}

  HalfTexel texel(int face, int x, int y) const {
    const auto n = static_cast<std::size_t>(size_);
    const std::uint16_t* rgb = &half_rgb_[3 * ((static_cast<std::size_t>(face) * n + static_cast<std::size_t>(y)) * n +
                                               static_cast<std::size_t>(x))];
    return {rgb[0], rgb[1], rgb[2], kHalfOne};
  }

  // x or y is −1 or the size: the texel beyond the edge, and at a corner the mean of the three that meet there.
  HalfTexel border(int face, int x, int y) const {
    const int near_x = std::clamp(x, 0, size_ - 1), near_y = std::clamp(y, 0, size_ - 1);
    if (x == near_x || y == near_y) return beyond_edge(face, x, y);
    const HalfTexel a = texel(face, near_x, near_y), b = beyond_edge(face, x, near_y), c = beyond_edge(face, near_x, y);
    HalfTexel mean{0, 0, 0, kHalfOne};
    for (std::size_t i = 0; i < 3; ++i)
      mean[i] =
          glm::packHalf1x16((glm::unpackHalf1x16(a[i]) + glm::unpackHalf1x16(b[i]) + glm::unpackHalf1x16(c[i])) / 3.0F);
    return mean;
  }

 private:
  HalfTexel beyond_edge(int face, int x, int y) const {
    const auto place = [&](int i) { return (i + 0.5) / size_; };
    const gl::CubeTexel there = gl::cube_texel(gl::cube_direction({face, place(x), place(y)}));
    const auto cell = [&](double s) { return std::clamp(static_cast<int>(s * size_), 0, size_ - 1); };
    return texel(there.face, cell(there.s), cell(there.t));
  }

  const std::vector<std::uint16_t>& half_rgb_;
  int size_;
};

}  // namespace

KeyAtlas key_atlas(const KeyChain& chain) {
  KeyAtlas atlas;
  const auto maps = static_cast<int>(chain.half_rgb.size());
  const auto size_of = [&](int map) {
    return static_cast<int>(std::lround(std::sqrt(chain.half_rgb[static_cast<std::size_t>(map)].size() / 18)));
  };
  const int n = size_of(0);
  atlas.map_size = n;
  // Where the map after the last would begin.
  const int column = n - 2 * (n >> maps) + 2 * (maps - 1);
  atlas.face_rows = std::max(n + 2, column);
  atlas.width = n + 2 + n / 2 + 2;
  atlas.height = gl::kCubeFaces * atlas.face_rows;
  atlas.half_rgba.assign(4 * static_cast<std::size_t>(atlas.width) * static_cast<std::size_t>(atlas.height), 0);
  for (int map = 0; map < maps; ++map) {
    const HalfMap texels(chain.half_rgb[static_cast<std::size_t>(map)], size_of(map));
    const int size = size_of(map);
    const int left = map == 0 ? 0 : n + 2, top = map == 0 ? 0 : n - 2 * size + 2 * (map - 1);
    for (int face = 0; face < gl::kCubeFaces; ++face) {
      for (int y = -1; y <= size; ++y) {
        const auto row = static_cast<std::size_t>(face * atlas.face_rows + top + 1 + y);
        std::uint16_t* out =
            &atlas.half_rgba[4 * (row * static_cast<std::size_t>(atlas.width) + static_cast<std::size_t>(left))];
        const auto put = [&](const HalfTexel& texel) { out = std::copy(texel.begin(), texel.end(), out); };
        const bool beyond = y < 0 || y == size;
        put(texels.border(face, -1, y));
        for (int x = 0; x < size; ++x)
          put(beyond ? texels.border(face, x, y) : texels.texel(face, x, y));
        put(texels.border(face, size, y));
      }
    }
  }
  return atlas;
}

}  // namespace pellucid::scattering
