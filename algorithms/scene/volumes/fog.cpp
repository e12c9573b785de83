#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "algorithms/scene/noise.hpp"
#include "algorithms/scene/shapes/procedural.hpp"
#include "algorithms/scene/volumes/volume_rows.hpp"

namespace pellucid {
std::vector<float> make_constant_density(const glm::ivec3& size, float density) {
  return std::vector<float>(voxel_count(size), density);
}

std::vector<float> make_fog_density(const glm::ivec3& size, const FogOptions& options) {
  assert(options.octaves >= 1 && options.frequency >= 0.0F && options.height_falloff >= 0.0F);
  assert(options.contrast >= 0.0F && options.contrast <= 1.0F);
  std::vector<float> density(voxel_count(size), 0.0F);
  for_each_row(size, density, [&](int y, int z, std::span<float> row) {
    const float v = voxel_centre(y, size.y), w = voxel_centre(z, size.z);
    float amplitude = 1.0F, total = 0.0F, frequency = options.frequency;
    for (int octave = 0; octave < options.octaves; ++octave) {
      // A shift by an irrational share keeps the lattices' zeros of two octaves apart.
      const float shift = 0.618034F * static_cast<float>(octave + 1);
      add_gradient_noise_row(voxel_centre(0, size.x) * frequency + shift, frequency / static_cast<float>(size.x),
                             v * frequency + shift, w * frequency + shift,
                             options.seed * 131U + static_cast<std::uint32_t>(octave), amplitude, row);
      total += amplitude;
      amplitude *= 0.5F;
      frequency *= 2.0F;
    }
    const float layer = std::exp(-options.height_falloff * v);
    for (float& value : row) {
      // Octaves rarely add up: half of the bound already counts as thickest or thinnest.
      const float thickness = std::clamp(0.5F + value / total, 0.0F, 1.0F);
      value = layer * (1.0F - options.contrast * (1.0F - thickness));
    }
  });
  return density;
}

std::vector<float> make_ball_density(const glm::ivec3& size) {
  constexpr int kLines = 16;  // lines of sight per voxel and axis, each with its exact length inside the ball
  std::vector<float> density(voxel_count(size), 0.0F);
  for_each_row(size, density, [&](int y, int z, std::span<float> row) {
    const auto n = static_cast<double>(size.x);
    std::vector<double> covered(row.size(), 0.0);
    std::vector<int> enter_leave(row.size() + 1, 0);  // differences of the number of lines that cover a voxel whole
    for (int j = 0; j < kLines; ++j) {
      const double v = 2.0 * (y + (j + 0.5) / kLines) / size.y - 1.0;
      for (int k = 0; k < kLines; ++k) {
        const double w = 2.0 * (z + (k + 0.5) / kLines) / size.z - 1.0;
        const double square = 1.0 - v * v - w * w;
        if (square <= 0.0) continue;
        const double half = 0.5 * n * std::sqrt(square);
        const double begin = 0.5 * n - half, end = 0.5 * n + half;
        const auto first = static_cast<std::size_t>(begin);
        const auto last = std::min(static_cast<std::size_t>(end), row.size() - 1);
        if (first == last) {
          covered[first] += end - begin;
        } else {
          covered[first] += static_cast<double>(first + 1) - begin;
          covered[last] += end - static_cast<double>(last);
          ++enter_leave[first + 1];
          --enter_leave[last];
        }
      }
    }
    int lines = 0;
    for (std::size_t x = 0; x < row.size(); ++x) {
      lines += enter_leave[x];
      row[x] = static_cast<float>((covered[x] + lines) / (kLines * kLines));
    }
  });
  return density;
}

}  // namespace pellucid
