#include "algorithms/translucent_relief/height_pyramid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include <fmt/format.h>
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

}  // namespace pellucid::translucent_relief
