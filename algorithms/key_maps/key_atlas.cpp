#include "algorithms/key_maps/key_atlas.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/gtc/packing.hpp>

#include "gl/cube_faces.hpp"

namespace pellucid::scattering {
namespace {

/// One map of the chain; texels as gl/cube_faces.hpp numbers them.
class HalfMap {
 public:
  HalfMap(const std::vector<std::uint16_t>& half_rgb, int size) : half_rgb_(half_rgb), size_(size) {}

  // x and y from −1 to the size: a border's texel is the one beyond the edge, and a corner's the mean of the three that
  // meet there.
  glm::vec3 bordered(int face, int x, int y) const {
    const int near_x = std::clamp(x, 0, size_ - 1), near_y = std::clamp(y, 0, size_ - 1);
    if (x == near_x && y == near_y) return texel(face, x, y);
    if (x == near_x || y == near_y) return beyond_edge(face, x, y);
    return (texel(face, near_x, near_y) + beyond_edge(face, x, near_y) + beyond_edge(face, near_x, y)) / 3.0F;
  }

 private:
  glm::vec3 texel(int face, int x, int y) const {
    const auto n = static_cast<std::size_t>(size_);
    const std::size_t at =
        (static_cast<std::size_t>(face) * n + static_cast<std::size_t>(y)) * n + static_cast<std::size_t>(x);
    glm::vec3 rgb;
    for (std::size_t c = 0; c < 3; ++c)
      rgb[static_cast<int>(c)] = glm::unpackHalf1x16(half_rgb_[3 * at + c]);
    return rgb;
  }
  glm::vec3 beyond_edge(int face, int x, int y) const {
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
  atlas.rgba.assign(4 * static_cast<std::size_t>(atlas.width) * static_cast<std::size_t>(atlas.height), 0.0F);
  for (int map = 0; map < maps; ++map) {
    const HalfMap texels(chain.half_rgb[static_cast<std::size_t>(map)], size_of(map));
    const int size = size_of(map);
    const int left = map == 0 ? 0 : n + 2, top = map == 0 ? 0 : n - 2 * size + 2 * (map - 1);
    for (int face = 0; face < gl::kCubeFaces; ++face) {
      for (int y = -1; y <= size; ++y) {
        const auto row = static_cast<std::size_t>(face * atlas.face_rows + top + 1 + y);
        float* out = &atlas.rgba[4 * (row * static_cast<std::size_t>(atlas.width) + static_cast<std::size_t>(left))];
        for (int x = -1; x <= size; ++x) {
          const glm::vec3 rgb = texels.bordered(face, x, y);
          for (const float value : {rgb.x, rgb.y, rgb.z, 1.0F})
            *out++ = value;
        }
      }
    }
  }
  return atlas;
}

}  // namespace pellucid::scattering
