#include "algorithms/scene/relief/patterns.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/scene/noise.hpp"

namespace pellucid {
namespace {

int wrapped(int i, int n) {
  const int r = i % n;
  return r < 0 ? r + n : r;
}

float smooth(float low, float high, float x) {
  return glm::smoothstep(low, high, x);
}

// Octaves of gradient noise in the plane that repeat after [0, 1]², each of twice the frequency and half the amplitude
// of the one before: about [−1, 1].
class FractalNoise {
 public:
  FractalNoise(int frequency, int octaves, std::uint32_t seed) {
    float amplitude = 1;
    for (int i = 0; i < octaves; ++i, frequency *= 2, amplitude *= 0.5F) {
      Octave& octave = octaves_.emplace_back(Octave{frequency, seed + static_cast<std::uint32_t>(i), amplitude, {}});
      total_ += amplitude;
      if (frequency > kMostKept) continue;
      for (int y = 0; y < frequency; ++y) {
        for (int x = 0; x < frequency; ++x)
          octave.kept.push_back(octave.gradient(x, y));
      }
    }
  }
  float at(const glm::vec2& uv) const {
    float sum = 0;
    for (const Octave& octave : octaves_)
      sum += octave.amplitude * octave.at(uv * static_cast<float>(octave.period));
    return sum / total_;
  }

 private:
  static constexpr int kMostKept = 512;  // finer gradients than those are used about once each

  struct Octave {
    int period;
    std::uint32_t seed;
    float amplitude;
    std::vector<glm::vec2> kept;

    glm::vec2 gradient(int x, int y) const {
      const float angle = 2.0F * std::numbers::pi_v<float> * unit_float(hash_bits(x, y, 0, seed));
      return {std::cos(angle), std::sin(angle)};
    }
    float at(const glm::vec2& p) const {
      const glm::vec2 cell = glm::floor(p), f = p - cell;
      const glm::vec2 w = f * f * f * (f * (f * 6.0F - 15.0F) + 10.0F);
      const auto corner = [&](int dx, int dy) {
        const int x = wrapped(static_cast<int>(cell.x) + dx, period),
                  y = wrapped(static_cast<int>(cell.y) + dy, period);
        const glm::vec2 g =
            kept.empty()
                ? gradient(x, y)
                : kept[static_cast<std::size_t>(y) * static_cast<std::size_t>(period) + static_cast<std::size_t>(x)];
        return g.x * (f.x - static_cast<float>(dx)) + g.y * (f.y - static_cast<float>(dy));
      };
      return 1.4F * glm::mix(glm::mix(corner(0, 0), corner(1, 0), w.x), glm::mix(corner(0, 1), corner(1, 1), w.x), w.y);
    }
  };
  std::vector<Octave> octaves_;
  float total_ = 0;
};

struct Texel {
  float height = 0;
  glm::vec3 color{1.0F};
};

// A tone for the thing with these whole coordinates, its channels a little apart.
glm::vec3 tone(int x, int y, const PatternOptions& options) {
  const auto random = [&](int k) { return unit_float(hash_bits(x, y, k, options.seed)); };
  const float bright = 1.0F - options.contrast * random(11);
  return bright * (1.0F - 0.25F * options.contrast * glm::vec3(random(12), random(13), random(14)));
}

Texel brick_at(const glm::vec2& uv, const PatternOptions& options, const FractalNoise& noise) {
  const int row = static_cast<int>(uv.y * static_cast<float>(options.rows));
  const float shift = row % 2 == 0 ? 0.0F : 0.5F;
  const float along = uv.x * static_cast<float>(options.columns) + shift;
  const int column = wrapped(static_cast<int>(std::floor(along)), options.columns);
  const glm::vec2 in(along - std::floor(along), uv.y * static_cast<float>(options.rows) - static_cast<float>(row));
  // Distance to the brick's edge in units of its height; bricks are about twice as long.
  const float aspect = static_cast<float>(options.rows) / static_cast<float>(options.columns);
  const float edge = std::min(std::min(in.x, 1.0F - in.x) * aspect, std::min(in.y, 1.0F - in.y));
  const float inside = smooth(0.5F * options.joint, 0.5F * options.joint + 0.12F, edge);
  const float own = 0.12F * unit_float(hash_bits(column, row, 10, options.seed));
  const float rough = noise.at(uv);
  const float fine = 0.5F * options.roughness * rough;
  Texel texel;
  texel.height = glm::mix(0.12F + fine, 0.82F - own + fine, inside);
  const glm::vec3 mortar = glm::vec3(0.8F, 0.9F, 1.0F) * 0.85F;
  texel.color = glm::mix(mortar, tone(column, row, options), inside) * (1.0F - 0.25F * std::abs(rough));
  return texel;
}

// Nearest and second nearest of one jittered point a cell; its cell, and the way to it in cells.
struct Nearest {
  float first = 9, second = 9;
  int x = 0, y = 0;
};
class JitteredPoints {
 public:
  JitteredPoints(const PatternOptions& options, float jitter) : columns_(options.columns), rows_(options.rows) {
    for (int y = 0; y < rows_; ++y) {
      for (int x = 0; x < columns_; ++x)
        offsets_.push_back(jitter * (glm::vec2(unit_float(hash_bits(x, y, 1, options.seed)),
                                               unit_float(hash_bits(x, y, 2, options.seed))) -
                                     0.5F));
    }
  }
  Nearest nearest(const glm::vec2& uv) const {
    const glm::vec2 p = uv * glm::vec2(columns_, rows_);
    const int cx = static_cast<int>(std::floor(p.x)), cy = static_cast<int>(std::floor(p.y));
    Nearest found;
    for (int y = cy - 2; y <= cy + 2; ++y) {
      for (int x = cx - 2; x <= cx + 2; ++x) {
        const int wx = wrapped(x, columns_), wy = wrapped(y, rows_);
        const glm::vec2 at = glm::vec2(x, y) + 0.5F + offsets_[static_cast<std::size_t>(wy * columns_ + wx)];
        const float distance = glm::distance(p, at);
        if (distance < found.first) {
          found = {distance, found.first, wx, wy};
        } else {
          found.second = std::min(found.second, distance);
        }
      }
    }
    return found;
  }

 private:
  int columns_, rows_;
  std::vector<glm::vec2> offsets_;
};

Texel stone_at(const glm::vec2& uv, const PatternOptions& options, const JitteredPoints& points,
               const FractalNoise& noise) {
  const Nearest near = points.nearest(uv);
  const float own = unit_float(hash_bits(near.x, near.y, 10, options.seed));
  const float edge = near.second - near.first;
  const float inside = smooth(options.joint, options.joint + 0.35F, edge);
  const float dome = std::sqrt(std::max(0.0F, 1.0F - near.first * near.first / 1.2F));
  const float rough = noise.at(uv);
  Texel texel;
  texel.height = inside * (0.45F + 0.2F * own) * dome + 0.15F + 0.5F * options.roughness * rough;
  texel.color = glm::mix(glm::vec3(0.45F, 0.4F, 0.35F), tone(near.x, near.y, options), inside) *
                (1.0F - 0.4F * options.roughness * (1.0F + rough));
  return texel;
}

Texel noise_at(const glm::vec2& uv, const PatternOptions& options, const FractalNoise& noise) {
  const float value = noise.at(uv);
  Texel texel;
  texel.height = 0.5F + 0.5F * value;
  texel.color = glm::vec3(1.0F - options.contrast * (0.5F - 0.5F * value));
  return texel;
}

// Rounded pieces of glass with gaps between them.
Texel cell_at(const glm::vec2& uv, const PatternOptions& options, const JitteredPoints& points) {
  const Nearest near = points.nearest(uv);
  const float edge = std::max(0.0F, near.second - near.first - options.joint);
  const float round = std::min(1.0F, edge / 0.6F);
  return {options.level * std::sqrt(round * (2.0F - round)), glm::vec3(1.0F)};
}

// A cut stone in each cell: a table, and slanted facets around it.
Texel gem_at(const glm::vec2& uv, const PatternOptions& options) {
  const glm::vec2 p = uv * glm::vec2(options.columns, options.rows);
  const glm::vec2 from_middle = p - glm::floor(p) - 0.5F;
  constexpr int kFacets = 8;
  float height = 1.0F;  // the table's
  for (int ring = 0; ring < 2; ++ring) {
    // A crown's main facets, which end at the table, and between them steeper ones at the girdle.
    const float steep = ring == 0 ? 4.0F : 5.0F, reach = ring == 0 ? 0.45F : 0.44F;
    for (int i = 0; i < kFacets; ++i) {
      const float angle = 2.0F * std::numbers::pi_v<float> * (static_cast<float>(i) + 0.5F * static_cast<float>(ring)) /
                          static_cast<float>(kFacets);
      const float out = from_middle.x * std::cos(angle) + from_middle.y * std::sin(angle);
      height = std::min(height, steep * (reach - out));
    }
  }
  return {options.level * std::max(height, 0.0F), glm::vec3(1.0F)};
}

Texel wave_at(const glm::vec2& uv, const std::vector<Sine>& sines, double time_s) {
  double sum = 0.5;
  for (const Sine& s : sines) {
    sum += static_cast<double>(s.amplitude) *
           std::cos(2.0 * std::numbers::pi * static_cast<double>(s.cycles_u * uv.x + s.cycles_v * uv.y) -
                    static_cast<double>(s.speed) * time_s + static_cast<double>(s.phase));
  }
  return {static_cast<float>(sum), glm::vec3(1.0F)};
}

}  // namespace

void make_sines(const PatternOptions& options, Sine* out) {
  assert(options.waves >= 1 && options.waves <= kMostSines);
  Random random(options.seed);
  float total = 0;
  for (int i = 0; i < options.waves; ++i) {
    // Whole numbers of waves across the map keep it seamless; the longer ones are the higher, about one direction.
    const float angle = 0.6F + random.range(-1.0F, 1.0F);
    const float length = static_cast<float>(options.frequency) * (0.6F + 1.4F * random.next());
    Sine& s = out[i];
    s.cycles_u = std::round(length * std::cos(angle));
    s.cycles_v = std::round(length * std::sin(angle));
    if (s.cycles_u == 0 && s.cycles_v == 0) s.cycles_u = 1;
    const float cycles = std::hypot(s.cycles_u, s.cycles_v);
    s.amplitude = 1.0F / (cycles * std::sqrt(cycles));
    s.phase = random.range(0.0F, 2.0F * std::numbers::pi_v<float>);
    // Gravity waves in deep water: ω² = g k.
    s.speed = std::sqrt(9.81F * 2.0F * std::numbers::pi_v<float> * cycles / options.size_m);
    total += s.amplitude;
  }
  for (int i = 0; i < options.waves; ++i)
    out[i].amplitude *= 0.5F / total;
}

PatternMaps make_pattern(const PatternOptions& options) {
  assert(options.width >= 1 && options.height >= 1);
  assert(options.kind != Pattern::drops && options.kind != Pattern::rain && options.kind != Pattern::file);
  std::vector<Sine> sines;
  std::function<Texel(const glm::vec2&)> at;
  switch (options.kind) {
    case Pattern::bricks:
      at = [&, noise = FractalNoise(16, 3, options.seed)](const glm::vec2& uv) { return brick_at(uv, options, noise); };
      break;
    case Pattern::stones:
      at = [&, points = JitteredPoints(options, 0.8F), noise = FractalNoise(8, 4, options.seed)](const glm::vec2& uv) {
        return stone_at(uv, options, points, noise);
      };
      break;
    case Pattern::noise:
      at = [&, noise = FractalNoise(options.frequency, options.octaves, options.seed)](const glm::vec2& uv) {
        return noise_at(uv, options, noise);
      };
      break;
    case Pattern::cells:
      at = [&, points = JitteredPoints(options, 0.7F)](const glm::vec2& uv) { return cell_at(uv, options, points); };
      break;
    case Pattern::gems:
      at = [&](const glm::vec2& uv) { return gem_at(uv, options); };
      break;
    case Pattern::waves:
      sines.resize(static_cast<std::size_t>(options.waves));
      make_sines(options, sines.data());
      at = [&](const glm::vec2& uv) { return wave_at(uv, sines, options.time_s); };
      break;
    default:
      at = [&](const glm::vec2&) { return Texel{options.level, glm::vec3(1.0F)}; };
  }
  const bool colored =
      options.kind == Pattern::bricks || options.kind == Pattern::stones || options.kind == Pattern::noise;
  PatternMaps maps{Image(options.width, options.height, 1),
                   colored ? Image(options.width, options.height, 3) : Image()};
  for (int y = 0; y < options.height; ++y) {
    for (int x = 0; x < options.width; ++x) {
      const Texel texel = at({(static_cast<float>(x) + 0.5F) / static_cast<float>(options.width),
                              (static_cast<float>(y) + 0.5F) / static_cast<float>(options.height)});
      *maps.heights.at(x, y) = std::clamp(texel.height, 0.0F, 1.0F);
      if (!colored) continue;
      for (int c = 0; c < 3; ++c)
        maps.colors.at(x, y)[c] = std::clamp(texel.color[c], 0.0F, 1.0F);
    }
  }
  return maps;
}

Image make_drops(const Image& ground_m, float below_m, const DropOptions& options) {
  const int width = ground_m.width, height = ground_m.height;
  Image surface(width, height, 1);
  std::fill(surface.pixels.begin(), surface.pixels.end(), below_m);
  for (int row = 0; row < options.rows; ++row) {
    for (int column = 0; column < options.columns; ++column) {
      const auto random = [&](int k) { return unit_float(hash_bits(column, row, k, options.seed)); };
      if (random(3) >= options.share) continue;
      const glm::vec2 cell(static_cast<float>(width) / static_cast<float>(options.columns),
                           static_cast<float>(height) / static_cast<float>(options.rows));
      const float size = 0.35F + 0.65F * random(4) * random(4);
      const float radius = options.radius * size * std::min(cell.x, cell.y);
      const float top_m = options.height_m * size;
      const glm::vec2 middle = cell * (glm::vec2(column, row) + 0.5F + 0.6F * (glm::vec2(random(5), random(6)) - 0.5F));
      const float base_m =
          *ground_m.at(wrapped(static_cast<int>(middle.x), width), wrapped(static_cast<int>(middle.y), height));
      const int reach = static_cast<int>(std::ceil(1.3F * radius)) + 1;
      for (int y = static_cast<int>(middle.y) - reach; y <= static_cast<int>(middle.y) + reach; ++y) {
        for (int x = static_cast<int>(middle.x) - reach; x <= static_cast<int>(middle.x) + reach; ++x) {
          const float r = glm::distance(glm::vec2(x, y) + 0.5F, middle) / radius;
          // A cap of a sphere, by its paraboloid, that goes on into the ground until it is cut.
          const float z = base_m + top_m * (1.0F - r * r);
          if (r > 1.3F) continue;
          float& texel = *surface.at(wrapped(x, width), wrapped(y, height));
          texel = std::max(texel, z);
        }
      }
    }
  }
  return surface;
}

Image slopes_of(const Image& heights) {
  const int width = heights.width, height = heights.height;
  Image slopes(width, height, 2);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto at = [&](int dx, int dy) { return *heights.at(wrapped(x + dx, width), wrapped(y + dy, height)); };
      slopes.at(x, y)[0] = 0.5F * static_cast<float>(width) * (at(1, 0) - at(-1, 0));
      slopes.at(x, y)[1] = 0.5F * static_cast<float>(height) * (at(0, 1) - at(0, -1));
    }
  }
  return slopes;
}

}  // namespace pellucid
