#include "algorithms/scene/relief/rain.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "algorithms/scene/noise.hpp"

namespace pellucid {
namespace {

constexpr int kMask = kRainUnits - 1;

int least_radius(const RainOptions& options) {
  return std::max(1, options.largest / 5);
}

RainDrop born(int index, int life, const RainOptions& options) {
  const auto random = [&](int k) { return static_cast<int>(hash_bits(index, life, k, options.seed) >> 8U); };
  RainDrop drop;
  drop.x = random(1) & kMask;
  drop.y = random(2) & kMask;
  drop.radius = least_radius(options) + random(3) % std::max(1, options.largest / 3);
  drop.life = life;
  return drop;
}

// Across the map's border the shorter way.
int apart(int a, int b) {
  return ((a - b + kRainUnits / 2) & kMask) - kRainUnits / 2;
}

bool touch(const RainDrop& a, const RainDrop& b) {
  const int dx = apart(a.x, b.x), dy = apart(a.y, b.y), reach = 3 * (a.radius + b.radius) / 4;
  return dx * dx + dy * dy < reach * reach;
}

// The larger of two drops takes the other; of equals the first.
bool takes(const std::vector<RainDrop>& drops, std::size_t a, std::size_t b) {
  return drops[a].radius > drops[b].radius || (drops[a].radius == drops[b].radius && a < b);
}

void move(RainDrop& drop, int index, int step, const RainOptions& options) {
  if ((step + index) % 8 == 0) drop.radius = std::min(drop.radius + 1, options.largest);
  const int sticks = options.largest / 2;
  if (drop.radius <= sticks) return;
  drop.y = (drop.y - 1 - (drop.radius - sticks) * options.fall / 16) & kMask;
  const int wobble = static_cast<int>(hash_bits(index, drop.y >> 6, 4, options.seed) >> 8U) % 3 - 1;
  drop.x = (drop.x + wobble) & kMask;
}

// The radius of that volume, at most `largest`.
int radius_of(unsigned volume, int from, int largest) {
  int radius = from;
  while (radius < largest && static_cast<unsigned>((radius + 1) * (radius + 1) * (radius + 1)) <= volume)
    ++radius;
  return radius;
}

void merge(std::vector<RainDrop>& drops, const RainOptions& options) {
  const std::size_t n = drops.size();
  std::vector<bool> smaller(n, false);  // touches one that takes it
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j)
      smaller[i] = smaller[i] || (j != i && touch(drops[i], drops[j]) && takes(drops, j, i));
  }
  const std::vector<RainDrop> before = drops;
  for (std::size_t i = 0; i < n; ++i) {
    if (smaller[i]) continue;
    unsigned volume = static_cast<unsigned>(before[i].radius * before[i].radius * before[i].radius);
    for (std::size_t j = 0; j < n; ++j) {
      if (!smaller[j] || !touch(before[i], before[j])) continue;
      // If several compete, the first takes it.
      bool first = true;
      for (std::size_t k = 0; k < i; ++k)
        first = first && !(!smaller[k] && touch(before[k], before[j]));
      if (!first) continue;
      volume += static_cast<unsigned>(before[j].radius * before[j].radius * before[j].radius);
      drops[j] = born(static_cast<int>(j), before[j].life + 1, options);
    }
    drops[i].radius = radius_of(volume, before[i].radius, options.largest);
  }
}

}  // namespace

std::vector<RainDrop> rain_drops(const RainOptions& options, int steps) {
  assert(options.drops >= 1 && options.drops <= kMostRainDrops && options.largest >= 1 && options.largest <= 400);
  std::vector<RainDrop> drops;
  for (int i = 0; i < options.drops; ++i)
    drops.push_back(born(i, 0, options));
  for (int step = 0; step < steps; ++step) {
    for (int i = 0; i < options.drops; ++i)
      move(drops[static_cast<std::size_t>(i)], i, step, options);
    merge(drops, options);
  }
  return drops;
}

Image rain_surface(const std::vector<RainDrop>& drops, const RainOptions& options, const Image& ground_m, float below_m,
                   float height_m) {
  const int width = ground_m.width, height = ground_m.height;
  Image surface(width, height, 1);
  std::fill(surface.pixels.begin(), surface.pixels.end(), below_m);
  constexpr auto kUnits = static_cast<float>(kRainUnits);
  for (const RainDrop& drop : drops) {
    const float radius = static_cast<float>(drop.radius), share = radius / static_cast<float>(options.largest);
    const float base_m = *ground_m.at(drop.x * width / kRainUnits, drop.y * height / kRainUnits);
    const int reach_x = 1 + static_cast<int>(1.3F * radius * static_cast<float>(width) / kUnits);
    const int reach_y = 1 + static_cast<int>(1.3F * radius * static_cast<float>(height) / kUnits);
    const int middle_x = drop.x * width / kRainUnits, middle_y = drop.y * height / kRainUnits;
    for (int j = middle_y - reach_y; j <= middle_y + reach_y; ++j) {
      for (int i = middle_x - reach_x; i <= middle_x + reach_x; ++i) {
        const int x = (i % width + width) % width, y = (j % height + height) % height;
        const auto away = [&](int texel, int size, int place) {
          const float d =
              (static_cast<float>(texel) + 0.5F) * kUnits / static_cast<float>(size) - static_cast<float>(place);
          return d - kUnits * std::round(d / kUnits);
        };
        const float r = std::hypot(away(x, width, drop.x), away(y, height, drop.y)) / radius;
        if (r > 1.3F) continue;
        float& texel = *surface.at(x, y);
        texel = std::max(texel, base_m + height_m * share * (1.0F - r * r));
      }
    }
  }
  return surface;
}

}  // namespace pellucid
