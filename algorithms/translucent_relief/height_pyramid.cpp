#include "algorithms/translucent_relief/height_pyramid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <tbb/parallel_for.h>

#include "gl/error.hpp"

namespace pellucid::translucent_relief {
namespace {

float wrapped(const Image& image, int x, int y, int channel = 0) {
  return image.at((x % image.width + image.width) % image.width,
                  (y % image.height + image.height) % image.height)[channel];
}

// Halves a map by its greatest heights, or its least, until no side is above the most.
Image reduced(Image heights, bool greatest) {
  while (std::max(heights.width, heights.height) > kMostConeTexels) {
    Image half(std::max(1, heights.width / 2), std::max(1, heights.height / 2), 1);
    for (int y = 0; y < half.height; ++y) {
      for (int x = 0; x < half.width; ++x) {
        float kept = greatest ? 0.0F : 1.0F;
        for (int i = 0; i < 16; ++i) {  // a texel more on each side, since heights are interpolated
          const float height = wrapped(heights, x * heights.width / half.width + i % 4 - 1,
                                       y * heights.height / half.height + i / 4 - 1);
          kept = greatest ? std::max(kept, height) : std::min(kept, height);
        }
        *half.at(x, y) = kept;
      }
    }
    heights = std::move(half);
  }
  return heights;
}

// Three periods of a map each way, so that nothing within one of the middle need be wrapped.
Image repeated(const Image& heights) {
  Image tiles(3 * heights.width, 3 * heights.height, 1);
  for (int y = 0; y < tiles.height; ++y) {
    for (int x = 0; x < tiles.width; ++x)
      *tiles.at(x, y) = *heights.at(x % heights.width, y % heights.height);
  }
  return tiles;
}

// Bilinear, at a place in texels that lies inside.
float sample(const Image& image, float x, float y) {
  const int i = static_cast<int>(x), k = static_cast<int>(y);
  const float fx = x - static_cast<float>(i), fy = y - static_cast<float>(k);
  const float *low = image.at(i, k), *high = low + image.width;
  const float below = low[0] + fx * (low[1] - low[0]), above = high[0] + fx * (high[1] - high[0]);
  return below + fy * (above - below);
}

/// Intervals of slopes, none of which touches another.
class Slopes {
 public:
  bool hold(float low, float high) const {
    return std::any_of(parts_.begin(), parts_.end(),
                       [&](const auto& part) { return part.first <= low && high <= part.second; });
  }
  void add(float low, float high) {
    std::erase_if(parts_, [&](const auto& part) {
      if (part.second < low || part.first > high) return false;
      low = std::min(low, part.first);
      high = std::max(high, part.second);
      return true;
    });
    parts_.emplace_back(low, high);
  }
  void clear() { parts_.clear(); }

 private:
  std::vector<std::pair<float, float>> parts_;
};

// The widest relaxed cone on `apex` along one direction, at most `best`. A ray from `origin` over the apex that falls
// by m per unit is in the solid where m exceeds (origin - height) / distance: it leaves where that rises over m again,
// and where it does so for the first time the cone must end. `heights`: repeated, (x, y) in the middle.
float relaxed_cone(const Image& heights, int x, int y, float apex, float origin, const glm::vec2& texels_per_step,
                   float step, float best, Slopes& left) {
  left.clear();
  float before = 0, height_before = apex;
  for (int i = 1; static_cast<float>(i) * step < best * (1.0F - apex); ++i) {
    const float away = static_cast<float>(i) * step;
    const float height = sample(heights, static_cast<float>(x) + static_cast<float>(i) * texels_per_step.x,
                                static_cast<float>(y) + static_cast<float>(i) * texels_per_step.y);
    const float slope = std::max((origin - height) / away, 0.0F);
    if (i > 1 && slope > before) {
      if (!left.hold(before, slope)) {
        if (height > apex) best = std::min(best, away / (height - apex));
        if (height_before > apex) best = std::min(best, (away - step) / (height_before - apex));
      }
      left.add(before, slope);
    }
    before = slope;
    height_before = height;
  }
  return best;
}

}  // namespace

std::vector<Image> height_pyramid(const Image& heights) {
  if (!std::has_single_bit(static_cast<unsigned>(heights.width)) ||
      !std::has_single_bit(static_cast<unsigned>(heights.height))) {
    throw InputError(fmt::format(
        "translucent_relief: search = max_mip takes maps whose sides are powers of two, and one has {}x{} texels",
        heights.width, heights.height));
  }
  std::vector<Image> levels;
  Image& first = levels.emplace_back(heights.width, heights.height, 2);
  for (int y = 0; y < heights.height; ++y) {
    for (int x = 0; x < heights.width; ++x) {
      const auto [least, most] = std::minmax({wrapped(heights, x, y), wrapped(heights, x + 1, y),
                                              wrapped(heights, x, y + 1), wrapped(heights, x + 1, y + 1)});
      first.at(x, y)[0] = most;
      first.at(x, y)[1] = least;
    }
  }
  while (levels.back().width > 1 || levels.back().height > 1) {
    const Image& finer = levels.back();
    Image next(std::max(1, finer.width / 2), std::max(1, finer.height / 2), 2);
    for (int y = 0; y < next.height; ++y) {
      for (int x = 0; x < next.width; ++x) {
        float most = 0, least = 1;
        for (int i = 0; i < 4; ++i) {
          most = std::max(most, wrapped(finer, 2 * x + i % 2, 2 * y + i / 2, 0));
          least = std::min(least, wrapped(finer, 2 * x + i % 2, 2 * y + i / 2, 1));
        }
        next.at(x, y)[0] = most;
        next.at(x, y)[1] = least;
      }
    }
    levels.push_back(std::move(next));
  }
  return levels;
}

Image cone_map(const Image& given) {
  const Image heights = reduced(given, true), apexes = reduced(given, false);
  const bool smaller = heights.width < given.width || heights.height < given.height;
  const int width = heights.width, height = heights.height;
  const float du = 1.0F / static_cast<float>(width), dv = 1.0F / static_cast<float>(height);
  Image cones(width, height, 1);
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const float apex = *apexes.at(x, y);
      // In a reduced map something as high as the greatest may stand anywhere in the texel itself.
      const float own = *heights.at(x, y) - apex;
      const float nearer = smaller ? 0.5F * std::min(du, dv) : 0.0F;
      float best = smaller && own > 0.0F ? std::min(1.0F, 0.5F * nearer / own) : 1.0F;
      const auto ask = [&](int dx, int dy) {
        const float higher = wrapped(heights, x + dx, y + dy) - apex;
        if (higher <= 0.0F) return;
        const float away = std::hypot(static_cast<float>(dx) * du, static_cast<float>(dy) * dv) - nearer;
        best = std::min(best, away / higher);
      };
      // Nothing rises higher than 1: rings farther away than that allows cannot narrow the cone.
      const float room = std::max(1.0F - apex, 1e-6F);
      for (int ring = 1; static_cast<float>(ring) * std::min(du, dv) < best * room; ++ring) {
        for (int i = -ring; i <= ring; ++i) {
          ask(i, -ring);
          ask(i, ring);
          ask(-ring, i);
          ask(ring, i);
        }
      }
      *cones.at(x, y) = best;
    }
  });
  return cones;
}

Image relaxed_cone_map(const Image& given) {
  constexpr int kDirections = 32, kOrigins = 4;
  const Image heights = reduced(given, true), apexes = reduced(given, false), empty = cone_map(given);
  const Image tiles = repeated(heights);
  const glm::vec2 texels(heights.width, heights.height);
  const float step = 1.0F / std::max(texels.x, texels.y);
  Image cones(heights.width, heights.height, 2);
  tbb::parallel_for(0, heights.height, [&](int y) {
    Slopes left;
    for (int x = 0; x < heights.width; ++x) {
      float best = 1.0F;
      for (int i = 0; i < kDirections; ++i) {
        const float angle = 2.0F * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(kDirections);
        const glm::vec2 texels_per_step = step * texels * glm::vec2(std::cos(angle), std::sin(angle));
        const float apex = *apexes.at(x, y);
        for (int k = 1; k <= kOrigins; ++k) {
          const float origin = apex + (1.0F - apex) * static_cast<float>(k) / static_cast<float>(kOrigins);
          best = relaxed_cone(tiles, heights.width + x, heights.height + y, apex, origin, texels_per_step, step, best,
                              left);
        }
      }
      cones.at(x, y)[0] = *empty.at(x, y);
      cones.at(x, y)[1] = std::max(best, *empty.at(x, y));
    }
  });
  return cones;
}

}  // namespace pellucid::translucent_relief
