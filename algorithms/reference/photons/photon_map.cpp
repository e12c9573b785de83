#include "algorithms/reference/photons/photon_map.hpp"

#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "algorithms/scene/noise.hpp"

namespace pellucid {
namespace {

// Surfaces that face differently, or lie behind one another, do not share their photons.
constexpr double kSameFace = 0.9;
constexpr double kThickness = 0.1;  // of the radius

}  // namespace

PhotonMap::PhotonMap(std::vector<Deposit> deposits, double radius_m) : radius_m_(radius_m) {
  assert(radius_m > 0.0 && deposits.size() < std::numeric_limits<std::uint32_t>::max());
  // A hashed grid of cells twice the radius wide: what is near lies in eight of them.
  begin_of_.assign(std::bit_ceil(deposits.size() + 1) + 1, 0);
  std::vector<std::uint32_t> bucket(deposits.size());
  for (std::size_t i = 0; i < deposits.size(); ++i) {
    bucket[i] = static_cast<std::uint32_t>(bucket_of(cell_of(glm::dvec3(deposits[i].position))));
    ++begin_of_[bucket[i] + 1];
  }
  for (std::size_t b = 1; b < begin_of_.size(); ++b)
    begin_of_[b] += begin_of_[b - 1];
  std::vector<std::uint32_t> next(begin_of_.begin(), begin_of_.end() - 1);
  deposits_.resize(deposits.size());
  for (std::size_t i = 0; i < deposits.size(); ++i)
    deposits_[next[bucket[i]]++] = deposits[i];
}

glm::ivec3 PhotonMap::cell_of(const glm::dvec3& point) const {
  // Cells may coincide beyond 2³⁰ of them; the distance is tested all the same.
  return glm::ivec3(glm::clamp(glm::floor(point / (2.0 * radius_m_)), glm::dvec3(-1e9), glm::dvec3(1e9)));
}

std::size_t PhotonMap::bucket_of(const glm::ivec3& cell) const {
  return hash_bits(cell.x, cell.y, cell.z, 0U) & (begin_of_.size() - 2);
}

PhotonMap::Irradiance PhotonMap::at(const glm::dvec3& point, const glm::dvec3& face) const {
  Irradiance sum;
  const double r2 = radius_m_ * radius_m_, peak = 2.0 / (std::numbers::pi * r2);
  const glm::ivec3 low = cell_of(point - radius_m_), high = cell_of(point + radius_m_);
  for (int z = low.z; z <= high.z; ++z) {
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x) {
        const glm::ivec3 cell(x, y, z);
        const std::size_t bucket = bucket_of(cell);
        for (std::uint32_t i = begin_of_[bucket]; i < begin_of_[bucket + 1]; ++i) {
          const glm::dvec3 position(deposits_[i].position), offset = position - point;
          const double height = glm::dot(offset, face);
          const double d2 = glm::dot(offset, offset) - height * height;
          if (d2 >= r2 || std::abs(height) > kThickness * radius_m_) continue;
          if (glm::dot(glm::dvec3(deposits_[i].face), face) < kSameFace) continue;
          if (cell_of(position) != cell) continue;  // another cell of the same bucket
          const glm::dvec3 part = glm::dvec3(deposits_[i].power_w) * (peak * (1.0 - d2 / r2));
          sum.mean += part;
          sum.variance += part * part;
        }
      }
    }
  }
  return sum;
}

}  // namespace pellucid
