#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <glm/glm.hpp>

/// The texels of a cube map as OpenGL numbers them: faces +x −x +y −y +z −z, s to the right and t downwards in [−1, 1],
/// texel centres at ((2i + 1)/n − 1). Between centres the map is bilinear, across the edges of its faces too
/// (GL_TEXTURE_CUBE_MAP_SEAMLESS), so a border has no seam and needs no texels of its own.
namespace pellucid::geocube {

struct CubeTexel {
  int face = 0, x = 0, y = 0;
};

/// Not normalised: on the cube [−1, 1]³ where |s|, |t| ≤ 1.
inline glm::dvec3 cube_direction(int face, double s, double t) {
  switch (face) {
    case 0:
      return {1, -t, -s};
    case 1:
      return {-1, -t, s};
    case 2:
      return {s, 1, t};
    case 3:
      return {s, -1, -t};
    case 4:
      return {s, -t, 1};
    default:
      return {-s, -t, -1};
  }
}

struct CubePoint {
  int face = 0;
  double s = 0, t = 0;
};

inline CubePoint cube_point(const glm::dvec3& d) {
  const glm::dvec3 a = glm::abs(d);
  if (a.x >= a.y && a.x >= a.z) return {d.x >= 0 ? 0 : 1, (d.x >= 0 ? -d.z : d.z) / a.x, -d.y / a.x};
  if (a.y >= a.z) return {d.y >= 0 ? 2 : 3, d.x / a.y, (d.y >= 0 ? d.z : -d.z) / a.y};
  return {d.z >= 0 ? 4 : 5, (d.z >= 0 ? d.x : -d.x) / a.z, -d.y / a.z};
}

/// A cube map of n × n texels a face.
class CubeGrid {
 public:
  explicit CubeGrid(int n = 1) : n_(n) {}
  int n() const { return n_; }
  std::size_t texels() const { return 6 * static_cast<std::size_t>(n_) * static_cast<std::size_t>(n_); }
  std::size_t index(const CubeTexel& t) const {
    const auto n = static_cast<std::size_t>(n_);
    return (static_cast<std::size_t>(t.face) * n + static_cast<std::size_t>(t.y)) * n + static_cast<std::size_t>(t.x);
  }
  CubeTexel texel(std::size_t index) const {
    const auto n = static_cast<std::size_t>(n_);
    return {static_cast<int>(index / (n * n)), static_cast<int>(index % n), static_cast<int>(index / n % n)};
  }
  /// Unit, through the texel's centre; x and y may lie outside the face.
  glm::dvec3 direction(const CubeTexel& t) const {
    return glm::normalize(cube_direction(t.face, (2.0 * t.x + 1) / n_ - 1, (2.0 * t.y + 1) / n_ - 1));
  }
  glm::dvec3 direction(std::size_t i) const { return direction(texel(i)); }
  /// The texel that a direction meets.
  CubeTexel nearest(const glm::dvec3& direction) const {
    const CubePoint p = cube_point(direction);
    return {p.face, cell(p.s), cell(p.t)};
  }
  /// Angle between neighbouring texels' directions in a face's middle, where they are farthest apart [rad].
  double texel_angle() const { return 2.0 / n_; }

  struct Sample {
    std::array<std::size_t, 4> index{};
    std::array<double, 4> weight{};
  };
  /// The bilinear filter's texels. A cube's corner has three: the missing one is their mean.
  Sample sample(const glm::dvec3& direction) const {
    const CubePoint p = cube_point(direction);
    const double x = (p.s + 1) * 0.5 * n_ - 0.5, y = (p.t + 1) * 0.5 * n_ - 0.5;
    const double x0 = std::floor(x), y0 = std::floor(y), u = x - x0, v = y - y0;
    Sample result;
    int missing = -1;
    for (int k = 0; k < 4; ++k) {
      const int i = static_cast<int>(x0) + k % 2, j = static_cast<int>(y0) + k / 2;
      const auto at = static_cast<std::size_t>(k);
      result.weight[at] = (k % 2 == 0 ? 1 - u : u) * (k / 2 == 0 ? 1 - v : v);
      const bool out_x = i < 0 || i >= n_, out_y = j < 0 || j >= n_;
      if (out_x && out_y) missing = k;
      CubeTexel t{p.face, i, j};
      if (out_x != out_y) t = nearest(this->direction(t));
      result.index[at] = out_x && out_y ? 0 : index(t);
    }
    if (missing >= 0) {
      const double share = result.weight[static_cast<std::size_t>(missing)] / 3;
      result.weight[static_cast<std::size_t>(missing)] = 0;
      for (int k = 0; k < 4; ++k) {
        if (k != missing) result.weight[static_cast<std::size_t>(k)] += share;
      }
    }
    return result;
  }

 private:
  int cell(double s) const { return std::clamp(static_cast<int>((s + 1) * 0.5 * n_), 0, n_ - 1); }
  int n_;
};

}  // namespace pellucid::geocube
