#include "algorithms/scene/noise.hpp"

#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace pellucid {
namespace {

float fade(float t) {
  return t * t * t * (t * (t * 6.0F - 15.0F) + 10.0F);
}
float mix(float a, float b, float t) {
  return a + t * (b - a);
}

// Towards the twelve edges of a cube; four are repeated so that four bits of the hash choose one.
constexpr std::array<std::array<float, 3>, 16> kGradients = {{{1, 1, 0},
                                                              {-1, 1, 0},
                                                              {1, -1, 0},
                                                              {-1, -1, 0},
                                                              {1, 0, 1},
                                                              {-1, 0, 1},
                                                              {1, 0, -1},
                                                              {-1, 0, -1},
                                                              {0, 1, 1},
                                                              {0, -1, 1},
                                                              {0, 1, -1},
                                                              {0, -1, -1},
                                                              {1, 1, 0},
                                                              {-1, 1, 0},
                                                              {0, -1, 1},
                                                              {0, -1, -1}}};

const std::array<float, 3>& gradient(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t seed) {
  return kGradients[hash_bits(x, y, z, seed) >> 28U];
}

// For a fixed (y, z) the noise between two lattice planes x = i and x = i + 1 is a fade between two linear functions
// of x. This is the one of plane i: offset + slope · (x − i).
struct Plane {
  float offset;
  float slope;
};
Plane lattice_plane(std::int32_t ix, std::int32_t iy, std::int32_t iz, float fy, float fz, std::uint32_t seed) {
  const auto& g00 = gradient(ix, iy, iz, seed);
  const auto& g10 = gradient(ix, iy + 1, iz, seed);
  const auto& g01 = gradient(ix, iy, iz + 1, seed);
  const auto& g11 = gradient(ix, iy + 1, iz + 1, seed);
  const float v = fade(fy), w = fade(fz);
  const float offset = mix(mix(g00[1] * fy + g00[2] * fz, g10[1] * (fy - 1.0F) + g10[2] * fz, v),
                           mix(g01[1] * fy + g01[2] * (fz - 1.0F), g11[1] * (fy - 1.0F) + g11[2] * (fz - 1.0F), v), w);
  const float slope = mix(mix(g00[0], g10[0], v), mix(g01[0], g11[0], v), w);
  return {offset, slope};
}

}  // namespace

std::uint32_t hash_bits(std::uint32_t x) {
  x ^= x >> 16U;
  x *= 0x7feb352dU;
  x ^= x >> 15U;
  x *= 0x846ca68bU;
  x ^= x >> 16U;
  return x;
}

std::uint32_t hash_bits(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t seed) {
  std::uint32_t h = hash_bits(seed ^ 0x9e3779b9U);
  h = hash_bits(h ^ static_cast<std::uint32_t>(x));
  h = hash_bits(h ^ (static_cast<std::uint32_t>(y) * 0x85ebca6bU));
  return hash_bits(h ^ (static_cast<std::uint32_t>(z) * 0xc2b2ae35U));
}

float unit_float(std::uint32_t bits) {
  return static_cast<float>(bits >> 8U) * 0x1p-24F;
}

Random::Random(std::uint32_t seed, std::uint32_t stream) : key_(hash_bits(hash_bits(seed) ^ (stream * 0x9e3779b9U))) {}

float Random::next() {
  return unit_float(hash_bits(key_ ^ hash_bits(++counter_)));
}

float Random::range(float low, float high) {
  return low + (high - low) * next();
}

int Random::below(int n) {
  assert(n > 0);
  return static_cast<int>(next() * static_cast<float>(n));
}

float value_noise(const glm::vec3& p, std::uint32_t seed) {
  const glm::vec3 cell = glm::floor(p);
  const glm::vec3 f = p - cell;
  const glm::ivec3 i(cell);
  const auto at = [&](int x, int y, int z) { return unit_float(hash_bits(i.x + x, i.y + y, i.z + z, seed)); };
  const float u = fade(f.x), v = fade(f.y), w = fade(f.z);
  const float near = mix(mix(at(0, 0, 0), at(1, 0, 0), u), mix(at(0, 1, 0), at(1, 1, 0), u), v);
  const float far = mix(mix(at(0, 0, 1), at(1, 0, 1), u), mix(at(0, 1, 1), at(1, 1, 1), u), v);
  return mix(near, far, w);
}

float gradient_noise(const glm::vec3& p, std::uint32_t seed) {
  float sum = 0.0F;
  add_gradient_noise_row(p.x, 1.0F, p.y, p.z, seed, 1.0F, {&sum, 1});
  return sum;
}

float fractal_noise(const glm::vec3& p, int octaves, std::uint32_t seed) {
  assert(octaves > 0);
  float sum = 0.0F, amplitude = 1.0F, total = 0.0F, frequency = 1.0F;
  for (int octave = 0; octave < octaves; ++octave) {
    sum += amplitude * gradient_noise(p * frequency, seed + static_cast<std::uint32_t>(octave));
    total += amplitude;
    amplitude *= 0.5F;
    frequency *= 2.0F;
  }
  return sum / total;
}

void add_gradient_noise_row(float x0, float dx, float y, float z, std::uint32_t seed, float amplitude,
                            std::span<float> sum) {
  assert(dx >= 0.0F);
  const float cell_y = std::floor(y), cell_z = std::floor(z);
  const float fy = y - cell_y, fz = z - cell_z;
  const auto iy = static_cast<std::int32_t>(cell_y);
  const auto iz = static_cast<std::int32_t>(cell_z);
  std::int32_t cell = 0;
  Plane left{}, right{};
  bool known = false;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const float x = x0 + static_cast<float>(i) * dx;
    const float cell_x = std::floor(x);
    const auto ix = static_cast<std::int32_t>(cell_x);
    if (!known || ix != cell) {
      left = known && ix == cell + 1 ? right : lattice_plane(ix, iy, iz, fy, fz, seed);
      right = lattice_plane(ix + 1, iy, iz, fy, fz, seed);
      cell = ix;
      known = true;
    }
    const float fx = x - cell_x;
    sum[i] += amplitude * mix(left.offset + left.slope * fx, right.offset + right.slope * (fx - 1.0F), fade(fx));
  }
}

}  // namespace pellucid
