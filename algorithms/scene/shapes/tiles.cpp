#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "algorithms/scene/shapes/procedural.hpp"

namespace pellucid {
namespace {

// A cut across the plane, and whether a joint or a tile lies behind it.
struct Strip {
  float begin, end;
  bool joint;
};

// Where tiles begin and end along an axis, in tiles. Both courses' cuts are made in every course, so that neighbours
// share all their corners and no crack opens between them.
std::vector<float> cuts(int count, float joint, bool running) {
  std::vector<float> at{0.0F, static_cast<float>(count)};
  const float half = 0.5F * joint;
  const auto add = [&](float x) {
    if (x > 0.0F && x < static_cast<float>(count)) at.push_back(x);
  };
  for (int i = 0; i <= count; ++i) {
    for (const float shift : {0.0F, 0.5F}) {
      if (shift > 0.0F && !running) continue;
      add(static_cast<float>(i) + shift - half);
      add(static_cast<float>(i) + shift + half);
    }
  }
  std::sort(at.begin(), at.end());
  at.erase(std::unique(at.begin(), at.end()), at.end());
  return at;
}

float unit(std::uint32_t seed, int column, int row, std::uint32_t channel) {
  std::seed_seq sequence{seed, static_cast<std::uint32_t>(column + 1), static_cast<std::uint32_t>(row), channel};
  std::mt19937 random(sequence);
  return static_cast<float>(random() >> 8U) * (1.0F / 16777216.0F);
}

}  // namespace

Mesh make_tiles(const TileOptions& options) {
  assert(options.columns >= 1 && options.rows >= 1 && options.joint >= 0 && options.joint < 1);
  Mesh mesh;
  mesh.name = "tiles";
  const auto columns = static_cast<float>(options.columns), rows = static_cast<float>(options.rows);
  const float half = 0.5F * options.joint;
  const float darkest = 1.0F - options.contrast;
  const glm::vec3 joint_color(0.5F * darkest + 0.1F);
  const auto tile_color = [&](int column, int row) {
    const float chance = unit(options.seed, column, row, 3);
    // Tiles in stack bond alternate, bricks differ at random.
    const bool dark = (column + row) % 2 != 0;
    const float tone = options.running ? chance : dark ? 1.0F - 0.2F * chance : 0.2F * chance;
    glm::vec3 color(1.0F - options.contrast * tone);
    for (int c = 0; c < 3; ++c)
      color[c] *= 1.0F - options.hue * unit(options.seed, column, row, static_cast<std::uint32_t>(c));
    return color;
  };
  const auto inside = [&](float x) { return x - std::floor(x) >= half && x - std::floor(x) <= 1.0F - half; };
  const std::vector<float> xs = cuts(options.columns, options.joint, options.running);
  const std::vector<float> zs = cuts(options.rows, options.joint, false);
  for (std::size_t j = 0; j + 1 < zs.size(); ++j) {
    const float z = 0.5F * (zs[j] + zs[j + 1]);
    const int row = static_cast<int>(z);
    const float shift = options.running && row % 2 != 0 ? 0.5F : 0.0F;
    for (std::size_t i = 0; i + 1 < xs.size(); ++i) {
      const float x = 0.5F * (xs[i] + xs[i + 1]) + shift;
      const glm::vec3 color = inside(x) && inside(z) ? tile_color(static_cast<int>(std::floor(x)), row) : joint_color;
      const auto first = static_cast<unsigned>(mesh.positions.size());
      for (const float corner_z : {zs[j], zs[j + 1]}) {
        for (const float corner_x : {xs[i], xs[i + 1]}) {
          const glm::vec2 uv(corner_x / columns, corner_z / rows);
          mesh.positions.emplace_back((uv.x - 0.5F) * options.size.x, 0.0F, (0.5F - uv.y) * options.size.y);
          mesh.normals.emplace_back(0.0F, 1.0F, 0.0F);
          mesh.uvs.push_back(uv);
          mesh.colors.push_back(color);
        }
      }
      mesh.triangles.emplace_back(first, first + 1, first + 3);
      mesh.triangles.emplace_back(first, first + 3, first + 2);
    }
  }
  return mesh;
}

}  // namespace pellucid
