#include "algorithms/key_maps/environment_filter.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include "algorithms/key_maps/sphere_map.hpp"
#include "gl/cube_faces.hpp"

namespace pellucid::scattering {
namespace {

using std::numbers::pi;
constexpr double kReach = 3.7;     // widths beyond which a Gaussian is cut off: 0.1 % of it
constexpr double kCells = 3;       // cells of the source map a width, at least, where the source has them
constexpr int kGradientRows = 64;  // of a map made from a gradient

// Calls visit(face, x, y, direction) for every texel of a cube map, in parallel; the direction is of unit length.
template <class F>
void for_texels(int size, F visit) {
  tbb::parallel_for(tbb::blocked_range2d<int>(0, gl::kCubeFaces * size, 1, 0, size, 16), [&](const auto& range) {
    for (int row = range.rows().begin(); row < range.rows().end(); ++row) {
      for (int x = range.cols().begin(); x < range.cols().end(); ++x) {
        visit((static_cast<std::size_t>(row) * static_cast<std::size_t>(size) + static_cast<std::size_t>(x)) * 3,
              texel_direction(size, row / size, x, row % size));
      }
    }
  });
}

void write(KeyMap& map, std::size_t at, const glm::dvec3& radiance) {
  for (int c = 0; c < 3; ++c)
    map.rgb[at + static_cast<std::size_t>(c)] = static_cast<float>(radiance[c]);
}

KeyMap empty_map(int size, double width) {
  const auto n = static_cast<std::size_t>(size);
  return {size, width, std::vector<float>(gl::kCubeFaces * n * n * 3)};
}

/// A Gaussian in the angle by 1 − cos of it, which is what a sum over cells has at hand. It is smooth there.
class Weights {
 public:
  Weights(double width, double reach) : end_(1 - std::cos(reach)), weights_(kEntries + 2) {
    for (int i = 0; i < kEntries + 2; ++i) {
      const double angle = std::acos(std::max(-1.0, 1 - end_ * i / kEntries));
      weights_[static_cast<std::size_t>(i)] = std::exp(-0.5 * angle * angle / (width * width));
    }
  }
  double end() const { return end_; }
  double at(double one_minus_cosine) const {
    const double place = one_minus_cosine / end_ * kEntries;
    const auto i = static_cast<std::size_t>(place);
    const double t = place - static_cast<double>(i);
    return weights_[i] + t * (weights_[i + 1] - weights_[i]);
  }

 private:
  static constexpr int kEntries = 2048;
  double end_;
  std::vector<double> weights_;
};

// The weighted mean of a map's cells around a direction.
glm::dvec3 gathered(const SphereMap& map, const glm::dvec3& direction, const Weights& weights, double reach) {
  const double polar = std::acos(std::clamp(direction.y, -1.0, 1.0)), sine = std::sin(polar);
  const double azimuth = std::atan2(direction.x, -direction.z);
  const double cell = pi / map.height();
  const int first = std::max(0, static_cast<int>(std::floor((polar - reach) / cell)));
  const int last = std::min(map.height() - 1, static_cast<int>(std::ceil((polar + reach) / cell)));
  const double columns_per_rad = map.width() / (2 * pi);
  const double middle = (azimuth + pi) * columns_per_rad - 0.5;
  glm::dvec3 sum(0.0);
  double total = 0;
  for (int y = first; y <= last; ++y) {
    // 1 − cos of the angle between is 1 − cos(θ − θ′) + sin θ sin θ′ (1 − cos Δφ).
    const double between = 0.5 * (map.polar(y) - polar), s = std::sin(between);
    const double along = 2 * s * s, across = sine * map.sine(y);
    if (along >= weights.end()) continue;
    const double widest = across > 0 ? (weights.end() - along) / across : 2;
    int half = map.width() / 2, from = 0, count = map.width();
    if (widest < 2) {
      half = static_cast<int>(std::acos(1 - widest) * columns_per_rad) + 1;
      from = static_cast<int>(std::floor(middle)) - half;
      count = std::min(map.width(), 2 * half + 2);
    }
    int x = ((from % map.width()) + map.width()) % map.width();
    const float* row = map.row(y);
    glm::dvec3 row_sum(0.0);
    double row_total = 0;
    const double ca = std::cos(azimuth), sa = std::sin(azimuth);
    for (int i = 0; i < count; ++i, x = x + 1 == map.width() ? 0 : x + 1) {
      const double off = along + across * (1 - (ca * map.column_cosine(x) + sa * map.column_sine(x)));
      if (off >= weights.end()) continue;
      const double w = weights.at(std::max(off, 0.0));
      row_total += w;
      const float* texel = row + 3 * static_cast<std::size_t>(x);
      row_sum +=
          w * glm::dvec3(static_cast<double>(texel[0]), static_cast<double>(texel[1]), static_cast<double>(texel[2]));
    }
    sum += map.area(y) * row_sum;
    total += map.area(y) * row_total;
  }
  assert(total > 0);
  return sum / total;
}

// A flat Gaussian filter of constant width in both directions, which runs on across the poles.
SphereMap flat_filtered(const SphereMap& map, double width) {
  const double sigma = width * map.height() / pi;
  const int reach = static_cast<int>(std::ceil(kReach * sigma));
  std::vector<double> kernel;
  double total = 0;
  for (int i = -reach; i <= reach; ++i) {
    kernel.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
    total += kernel.back();
  }
  for (double& k : kernel)
    k /= total;
  SphereMap across(map.width(), map.height()), out(map.width(), map.height());
  for (const bool along_rows : {true, false}) {
    const SphereMap& from = along_rows ? map : across;
    SphereMap& to = along_rows ? across : out;
    tbb::parallel_for(0, map.height(), [&](int y) {
      for (int x = 0; x < map.width(); ++x) {
        glm::dvec3 sum(0.0);
        for (int i = -reach; i <= reach; ++i) {
          const double k = kernel[static_cast<std::size_t>(i + reach)];
          sum += k * (along_rows ? from.across_poles(x + i, y) : from.across_poles(x, y + i));
        }
        to.set(x, y, sum);
      }
    });
  }
  return out;
}

// A direction in the system whose pole is a coordinate axis: 0 is x, 1 is y, 2 is z.
glm::dvec3 turned(const glm::dvec3& d, int pole) {
  return {d[(pole + 2) % 3], d[pole], d[(pole + 1) % 3]};
}
glm::dvec3 turned_back(const glm::dvec3& d, int pole) {
  glm::dvec3 out;
  out[(pole + 2) % 3] = d.x;
  out[pole] = d.y;
  out[(pole + 1) % 3] = d.z;
  return out;
}

}  // namespace

FilterSource::FilterSource(const Environment& environment) {
  check_environment(environment);
  maps_.push_back(environment.image ? SphereMap(*environment.image) : SphereMap(environment, kGradientRows));
  mean_ = maps_.front().mean();
  while (maps_.back().height() % 2 == 0 && maps_.back().height() > 8)
    maps_.push_back(maps_.back().halved());
}

FilterSource::~FilterSource() = default;
FilterSource::FilterSource(FilterSource&&) noexcept = default;

// The coarsest map whose cells are small beside the width; a finer one is made where even the source's are not.
const SphereMap& FilterSource::map_for(double width, SphereMap& finer) const {
  const auto fits = [&](const SphereMap& map, double cells) { return pi / map.height() * cells <= width; };
  for (std::size_t i = maps_.size(); i-- > 0;) {
    if (fits(maps_[i], kCells)) return maps_[i];
  }
  if (fits(maps_.front(), 1)) return maps_.front();
  // By whole powers of two, so that every source cell keeps its share.
  int height = maps_.front().height();
  while (pi / height > width && height < 8192)
    height *= 2;
  finer = maps_.front().resampled(height);
  return finer;
}

KeyMap FilterSource::direct(int size, double width) const {
  SphereMap finer;
  const SphereMap& map = map_for(width, finer);
  const double reach = std::min(kReach * width, pi);
  const Weights weights(width, reach);
  KeyMap out = empty_map(size, width);
  for_texels(size, [&](std::size_t at, const glm::dvec3& d) { write(out, at, gathered(map, d, weights, reach)); });
  return out;
}

KeyMap FilterSource::three_maps(int size, double width) const {
  SphereMap finer;
  const SphereMap& map = map_for(width, finer);
  std::array<SphereMap, 3> filtered;
  for (int pole = 0; pole < 3; ++pole) {
    SphereMap turned_map(map.width(), map.height());
    tbb::parallel_for(0, map.height(), [&](int y) {
      for (int x = 0; x < map.width(); ++x)
        turned_map.set(x, y, map.at(turned_back(turned_map.direction(x, y), pole)));
    });
    filtered[static_cast<std::size_t>(pole)] = flat_filtered(turned_map, width);
  }
  KeyMap out = empty_map(size, width);
  for_texels(size, [&](std::size_t at, const glm::dvec3& d) {
    glm::dvec3 sum(0.0);
    double total = 0;
    for (int pole = 0; pole < 3; ++pole) {
      // Near the equator there is little distortion; a high power leaves a map's poles to the others.
      const double cosine2 = std::max(0.0, 1 - d[pole] * d[pole]), weight = std::pow(cosine2, 4);
      sum += weight * filtered[static_cast<std::size_t>(pole)].at(turned(d, pole));
      total += weight;
    }
    write(out, at, sum / total);
  });
  return out;
}

KeyMap FilterSource::filtered(SphereFilter filter, int size, double width) const {
  assert(size > 0 && width > 0);
  return filter == SphereFilter::direct ? direct(size, width) : three_maps(size, width);
}

KeyMap FilterSource::mean(int size) const {
  KeyMap out = empty_map(size, pi);
  for_texels(size, [&](std::size_t at, const glm::dvec3&) { write(out, at, mean_); });
  return out;
}

std::vector<KeyMap> key_maps(const Environment& environment, const KeyWidths& widths, int face_size,
                             SphereFilter filter, const std::function<void(double)>& progress) {
  const FilterSource source(environment);
  std::vector<KeyMap> out;
  for (int level = 1; level <= widths.levels(); ++level) {
    const int size = std::max(1, face_size >> level);
    out.push_back(level == widths.levels() ? source.mean(size) : source.filtered(filter, size, widths.width(level)));
    out.back().width = widths.width(level);
    if (progress) progress(static_cast<double>(level) / widths.levels());
  }
  return out;
}

glm::dvec3 mean_over_sphere(const KeyMap& map) {
  glm::dvec3 sum(0.0);
  double total = 0;
  std::size_t at = 0;
  for (int face = 0; face < gl::kCubeFaces; ++face) {
    for (int y = 0; y < map.size; ++y) {
      for (int x = 0; x < map.size; ++x, at += 3) {
        const double area = texel_area(map.size, x, y);
        sum += area * glm::dvec3(static_cast<double>(map.rgb[at]), static_cast<double>(map.rgb[at + 1]),
                                 static_cast<double>(map.rgb[at + 2]));
        total += area;
      }
    }
  }
  return sum / total;
}

double relative_rms(const KeyMap& map, const KeyMap& reference) {
  assert(map.size == reference.size);
  double squares = 0, all = 0;
  std::size_t at = 0;
  for (int face = 0; face < gl::kCubeFaces; ++face) {
    for (int y = 0; y < map.size; ++y) {
      for (int x = 0; x < map.size; ++x) {
        const double area = texel_area(map.size, x, y);
        for (int c = 0; c < 3; ++c, ++at) {
          const double truth = static_cast<double>(reference.rgb[at]), off = static_cast<double>(map.rgb[at]) - truth;
          squares += area * off * off;
          all += area * truth * truth;
        }
      }
    }
  }
  return all > 0 ? std::sqrt(squares / all) : 0;
}

}  // namespace pellucid::scattering
