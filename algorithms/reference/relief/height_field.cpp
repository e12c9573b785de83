#include "algorithms/reference/relief/height_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace pellucid {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::size_t wrapped(long i, int n) {
  const long r = i % n;
  return static_cast<std::size_t>(r < 0 ? r + n : r);
}

// Channel `c` of an image at a texture coordinate, bilinear and repeated.
double sample(const Image& image, const glm::dvec2& uv, std::size_t c) {
  const glm::dvec2 at = uv * glm::dvec2(image.width, image.height) - 0.5;
  const glm::dvec2 low = glm::floor(at), f = at - low;
  const auto texel = [&](long dx, long dy) {
    const std::size_t x = wrapped(static_cast<long>(low.x) + dx, image.width);
    const std::size_t y = wrapped(static_cast<long>(low.y) + dy, image.height);
    return static_cast<double>(
        image.pixels[(y * static_cast<std::size_t>(image.width) + x) * static_cast<std::size_t>(image.channels) + c]);
  };
  return glm::mix(glm::mix(texel(0, 0), texel(1, 0), f.x), glm::mix(texel(0, 1), texel(1, 1), f.x), f.y);
}

// The first t in [begin, end] where the quadratic a t² + b t + c falls through 0; `begin` itself if it is below 0 there
// and falls.
std::optional<double> first_fall(double a, double b, double c, double begin, double end, bool first_cell) {
  const auto value = [&](double t) { return (a * t + b) * t + c; };
  const auto slope = [&](double t) { return 2.0 * a * t + b; };
  if (first_cell && value(begin) <= 0.0 && slope(begin) < 0.0) return begin;
  double roots[2] = {kInfinity, kInfinity};
  if (std::abs(a) * (end - begin) * (end - begin) < 1e-14 * (std::abs(b) * (end - begin) + std::abs(c))) {
    if (b != 0.0) roots[0] = -c / b;
  } else {
    const double root2 = b * b - 4.0 * a * c;
    if (root2 >= 0.0) {
      const double q = -0.5 * (b + std::copysign(std::sqrt(root2), b));
      roots[0] = q / a;
      if (q != 0.0) roots[1] = c / q;
      if (roots[0] > roots[1]) std::swap(roots[0], roots[1]);
    }
  }
  for (const double root : roots) {
    if (root >= begin && root <= end && slope(root) < 0.0) return root;
  }
  // Rounding at the cell's border.
  if (value(begin) > 0.0 && value(end) < 0.0) return end;
  return std::nullopt;
}

}  // namespace

HeightField::HeightField(const ReliefLayer& layer, const glm::dvec2& tiling) : layer_(&layer), tiling_(tiling) {}

double HeightField::texel(long x, long y) const {
  const Image& image = layer_->heights;
  const double share = static_cast<double>(
      image.pixels[wrapped(y, image.height) * static_cast<std::size_t>(image.width) + wrapped(x, image.width)]);
  return low_m() + (high_m() - low_m()) * share;
}

double HeightField::height_m(const glm::dvec2& mesh_uv) const {
  return low_m() + (high_m() - low_m()) * sample(layer_->heights, mesh_uv * tiling_, 0);
}

glm::dvec3 HeightField::normal(const glm::dvec2& mesh_uv, const glm::dvec2& uv_per_metre) const {
  const glm::dvec2 uv = mesh_uv * tiling_;
  const glm::dvec2 xy(sample(layer_->normals, uv, 0), sample(layer_->normals, uv, 1));
  if (layer_->normal_map) return glm::normalize(glm::dvec3(xy, sample(layer_->normals, uv, 2)));
  return glm::normalize(glm::dvec3(-(high_m() - low_m()) * xy * tiling_ * uv_per_metre, 1.0));
}

glm::dvec3 HeightField::color(const glm::dvec2& mesh_uv) const {
  if (layer_->colors.width == 0) return glm::dvec3(1.0);
  const glm::dvec2 uv = mesh_uv * tiling_;
  return {sample(layer_->colors, uv, 0), sample(layer_->colors, uv, 1), sample(layer_->colors, uv, 2)};
}

double HeightField::mean_m() const {
  const std::vector<float>& heights = layer_->heights.pixels;
  return glm::mix(low_m(), high_m(),
                  std::accumulate(heights.begin(), heights.end(), 0.0) / static_cast<double>(heights.size()));
}

std::optional<double> HeightField::crossing(const ReliefRay& ray, double from, double to, double side) const {
  if (!(from <= to)) return std::nullopt;
  // In units of texels, whole numbers at their centres.
  const glm::dvec2 size(layer_->heights.width, layer_->heights.height);
  const glm::dvec2 start = ray.uv_at(0.0) * tiling_ * size - 0.5;
  const glm::dvec2 speed = glm::dvec2(ray.direction) * ray.uv_per_metre * tiling_ * size;
  double begin = from;
  // Which cell: by the middle of the way to the next line, so that rounding cannot choose its neighbour.
  const auto next_line = [&](int axis, double t) {
    if (speed[axis] == 0.0) return kInfinity;
    const double at = start[axis] + t * speed[axis];
    const double line = speed[axis] > 0.0 ? std::floor(at) + 1.0 : std::ceil(at) - 1.0;
    return (line - start[axis]) / speed[axis];
  };
  glm::dvec2 next(next_line(0, begin), next_line(1, begin));
  const glm::dvec2 stride(speed.x == 0.0 ? kInfinity : 1.0 / std::abs(speed.x),
                          speed.y == 0.0 ? kInfinity : 1.0 / std::abs(speed.y));
  bool first_cell = true;
  while (begin <= to) {
    const double end = std::min({next.x, next.y, to});
    if (end > begin || first_cell) {
      const glm::dvec2 cell = glm::floor(start + 0.5 * (begin + std::max(end, begin)) * speed);
      const long x = static_cast<long>(cell.x), y = static_cast<long>(cell.y);
      const double h00 = texel(x, y), h10 = texel(x + 1, y), h01 = texel(x, y + 1), h11 = texel(x + 1, y + 1);
      // Relative to the cell's begin, where numbers are small.
      const glm::dvec2 f = start + begin * speed - cell;
      const double along_x = h10 - h00, along_y = h01 - h00, twist = h11 - h10 - h01 + h00;
      const double h = h00 + along_x * f.x + along_y * f.y + twist * f.x * f.y;
      const double a = -side * twist * speed.x * speed.y;
      const double b = side * (ray.direction.z - (along_x + twist * f.y) * speed.x - (along_y + twist * f.x) * speed.y);
      const double c = side * (ray.at(begin).z - h);
      if (const auto fall = first_fall(a, b, c, 0.0, std::max(end - begin, 0.0), first_cell)) return begin + *fall;
      first_cell = false;
    }
    if (!(end < to)) break;
    begin = end;
    for (int axis = 0; axis < 2; ++axis) {
      if (next[axis] <= end) next[axis] += stride[axis];
    }
  }
  return std::nullopt;
}

std::optional<glm::dvec2> clip(const ReliefRay& ray, double low_m, double high_m, bool cut, double from) {
  const glm::dvec3 position(ray.uv_at(0.0), ray.origin.z);
  const glm::dvec3 speed(glm::dvec2(ray.direction) * ray.uv_per_metre, ray.direction.z);
  const glm::dvec3 least(0.0, 0.0, low_m), most(1.0, 1.0, high_m);
  glm::dvec2 range(from, kInfinity);
  for (int axis = cut ? 0 : 2; axis < 3; ++axis) {
    if (speed[axis] == 0.0) {
      if (position[axis] < least[axis] || position[axis] > most[axis]) return std::nullopt;
      continue;
    }
    const double a = (least[axis] - position[axis]) / speed[axis], b = (most[axis] - position[axis]) / speed[axis];
    range = {std::max(range.x, std::min(a, b)), std::min(range.y, std::max(a, b))};
  }
  if (!(range.x <= range.y)) return std::nullopt;
  // A ray along a plane in a field that repeats has no end; somewhere it must have one.
  range.y = std::min(range.y, range.x + 1e4);
  return range;
}

}  // namespace pellucid
