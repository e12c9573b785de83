#pragma once

#include <cstdint>
#include <span>

#include <glm/glm.hpp>

/// Noise and random numbers from integer hashes: the same on every platform for a seed.
namespace pellucid {

/// Mixes all bits of x (a bijection on 32 bits).
std::uint32_t hash_bits(std::uint32_t x);
std::uint32_t hash_bits(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t seed);
/// The upper 24 bits as a number in [0, 1).
float unit_float(std::uint32_t bits);

/// A counter-based stream of random numbers.
class Random {
 public:
  explicit Random(std::uint32_t seed, std::uint32_t stream = 0);
  float next();                        ///< in [0, 1)
  float range(float low, float high);  ///< in [low, high)
  int below(int n);                    ///< in {0, …, n − 1}

 private:
  std::uint32_t key_;
  std::uint32_t counter_ = 0;
};

/// Random values at the integer lattice, joined by a quintic fade: in [0, 1).
float value_noise(const glm::vec3& p, std::uint32_t seed);
/// Perlin's gradient noise with the twelve edge directions: in [−1, 1], 0 at the lattice points.
float gradient_noise(const glm::vec3& p, std::uint32_t seed);
/// Sum of `octaves` of gradient noise, each of twice the frequency and half the amplitude, divided by the sum of the
/// amplitudes: in [−1, 1].
float fractal_noise(const glm::vec3& p, int octaves, std::uint32_t seed);
/// Adds amplitude · gradient_noise((x0 + i·dx, y, z)) to sum[i]; dx ≥ 0. The lattice's work is done once per cell.
void add_gradient_noise_row(float x0, float dx, float y, float z, std::uint32_t seed, float amplitude,
                            std::span<float> sum);

}  // namespace pellucid
