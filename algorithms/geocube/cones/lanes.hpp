#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <experimental/simd>
#include <glm/glm.hpp>

/// Four numbers side by side, as the processor's vector units take them, in single precision.
namespace pellucid::geocube {

namespace stdx = std::experimental;

using Four = stdx::simd<float, stdx::simd_abi::deduce_t<float, 4>>;
using FourFlags = Four::mask_type;

/// A bit for each lane, the first one lowest.
inline unsigned bits_of(const FourFlags& flags) {
  return static_cast<unsigned>(flags.__to_bitset().to_ulong());  // libstdc++'s own; the standard has none
}

/// As a tree keeps them.
struct alignas(16) FourKept {
  std::array<float, 4> lanes{};
  float& operator[](std::size_t k) { return lanes[k]; }
  operator Four() const { return Four(lanes.data(), stdx::vector_aligned); }  // NOLINT: a load is no conversion
};

struct FourVectorsKept {
  FourKept x, y, z;
  void set(std::size_t k, const glm::dvec3& v) {
    x[k] = static_cast<float>(v.x);
    y[k] = static_cast<float>(v.y);
    z[k] = static_cast<float>(v.z);
  }
};

struct FourVectors {
  Four x, y, z;
  FourVectors(const Four& x_, const Four& y_, const Four& z_) : x(x_), y(y_), z(z_) {}
  FourVectors(const FourVectorsKept& v) : x(v.x), y(v.y), z(v.z) {}  // NOLINT: a load is no conversion
  FourVectors minus(const glm::vec3& v) const { return {x - v.x, y - v.y, z - v.z}; }
  FourVectors minus(const Four& share, const glm::vec3& v) const {
    return {x - share * v.x, y - share * v.y, z - share * v.z};
  }
  FourVectors times(const Four& share) const { return {share * x, share * y, share * z}; }
};
inline Four dot(const FourVectors& a, const FourVectors& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Four dot(const FourVectors& a, const glm::vec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[gnu::always_inline]] inline Four length(const FourVectors& v) {
  return stdx::sqrt(dot(v, v));
}
inline FourVectors abs(const FourVectors& a) {
  return {stdx::abs(a.x), stdx::abs(a.y), stdx::abs(a.z)};
}

/// The normal of the plane that touches a cone about the axis, with its apex at the origin, on the side of each vector;
/// it points away from the cone.
[[gnu::always_inline]] inline FourVectors touching_normal(const FourVectors& v, const glm::vec3& axis, float cosine,
                                                          float sine) {
  // Perpendicular to the axis to rounding, however near to it, by doing it twice.
  FourVectors across = v.minus(dot(v, axis), axis);
  across = across.minus(dot(across, axis), axis);
  return across.times(cosine / (stdx::sqrt(dot(across, across)) + 1e-30F)).minus(sine, axis);
}

}  // namespace pellucid::geocube
