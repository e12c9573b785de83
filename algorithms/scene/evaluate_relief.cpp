#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "algorithms/scene/noise.hpp"
#include "algorithms/scene/relief/motion.hpp"
#include "algorithms/scene/toml/scene_description.hpp"

namespace pellucid {
namespace {

PatternOptions options_of(const ReliefLayerDescription& from, double time_s) {
  const auto f = [](double v) { return static_cast<float>(v); };
  PatternOptions options;
  options.kind = from.kind;
  options.width = whole(from.texels.x);
  options.height = whole(from.texels.y);
  options.seed = static_cast<std::uint32_t>(from.seed);
  options.columns = whole(from.columns);
  options.rows = whole(from.rows);
  options.joint = f(from.joint);
  options.frequency = whole(from.frequency);
  options.octaves = whole(from.octaves);
  options.roughness = f(from.roughness);
  options.contrast = f(from.contrast);
  options.level = f(from.level);
  options.waves = whole(from.waves);
  options.size_m = f(from.size_m);
  options.time_s = time_s;
  return options;
}

// Heights in metres at the texels of a map of `width` × `height`, bilinear.
Image in_metres(const ReliefLayer& layer, int width, int height) {
  const Image& from = layer.heights;
  const auto at = [&](int x, int y) {
    return *from.at((x + from.width) % from.width, (y + from.height) % from.height);
  };
  Image out(width, height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float u =
          (static_cast<float>(x) + 0.5F) / static_cast<float>(width) * static_cast<float>(from.width) - 0.5F;
      const float v =
          (static_cast<float>(y) + 0.5F) / static_cast<float>(height) * static_cast<float>(from.height) - 0.5F;
      const int x0 = static_cast<int>(std::floor(u)), y0 = static_cast<int>(std::floor(v));
      const float fx = u - static_cast<float>(x0), fy = v - static_cast<float>(y0);
      const float value =
          glm::mix(glm::mix(at(x0, y0), at(x0 + 1, y0), fx), glm::mix(at(x0, y0 + 1), at(x0 + 1, y0 + 1), fx), fy);
      *out.at(x, y) = glm::mix(layer.low_m, layer.high_m, value);
    }
  }
  return out;
}

[[noreturn]] void refuse_height(const SceneDescription& scene, const ReliefDescription& from, float top_m) {
  throw scene.file.error(from.place,
                         fmt::format("reliefs.{}: its drops reach {} m above the mesh; lower solid.high, or "
                                     "the drops' height",
                                     from.name, top_m));
}

// The layer's heights out of a surface in metres.
void set_surface(Image surface_m, float low_m, float high_m, ReliefLayer& out) {
  for (float& texel : surface_m.pixels)
    texel = std::clamp((texel - low_m) / (high_m - low_m), 0.0F, 1.0F);
  out.low_m = low_m;
  out.high_m = high_m;
  out.heights = std::move(surface_m);
}

// Where there is no drop the surface lies well under the solid, so that drops end steeply in it.
void lay_drops(const SceneDescription& scene, const ReliefDescription& from, const ReliefLayerDescription& drops,
               const ReliefLayer& solid, double time_s, ReliefLayer& out) {
  const Image ground = in_metres(solid, whole(drops.texels.x), whole(drops.texels.y));
  const auto height_m = static_cast<float>(drops.height_m);
  const float below_m = solid.low_m - height_m;
  if (drops.kind == Pattern::rain) {
    RainOptions options;
    options.seed = static_cast<std::uint32_t>(drops.seed);
    options.drops = whole(drops.drops);
    options.largest = whole(drops.radius * kRainUnits);
    options.fall = whole(drops.fall);
    const float top_m = solid.high_m + height_m;
    if (top_m > 0.0F) refuse_height(scene, from, top_m);
    const int steps = static_cast<int>(time_s * kRainSteps);
    set_surface(rain_surface(rain_drops(options, steps), options, ground, below_m, height_m), below_m, top_m, out);
    out.motion =
        std::make_shared<ReliefMotion>(ReliefMotion{{}, time_s, options, steps, ground, below_m, top_m, height_m});
    return;
  }
  DropOptions options;
  options.seed = static_cast<std::uint32_t>(drops.seed);
  options.columns = whole(drops.columns);
  options.rows = whole(drops.rows);
  options.share = static_cast<float>(drops.share);
  options.radius = static_cast<float>(drops.radius);
  options.height_m = height_m;
  Image surface = make_drops(ground, below_m, options);
  const float top_m = std::max(*std::max_element(surface.pixels.begin(), surface.pixels.end()), below_m + 1e-6F);
  if (top_m > 0.0F) refuse_height(scene, from, top_m);
  set_surface(std::move(surface), below_m, top_m, out);
}

ReliefLayer make_layer(const SceneDescription& scene, const ReliefDescription& relief,
                       const ReliefLayerDescription& from, std::string_view name, const ReliefLayer* solid,
                       double time_s) {
  ReliefLayer layer;
  if (from.kind == Pattern::drops || from.kind == Pattern::rain) {
    lay_drops(scene, relief, from, *solid, time_s, layer);
  } else {
    if (!(from.low_m < from.high_m)) {
      throw scene.file.error(relief.place, fmt::format("reliefs.{}.{}: low {} must be below high {}", relief.name, name,
                                                       from.low_m, from.high_m));
    }
    layer.low_m = static_cast<float>(from.low_m);
    layer.high_m = static_cast<float>(from.high_m);
    if (from.kind == Pattern::file) {
      layer.heights = from.heights;
    } else {
      const PatternOptions options = options_of(from, time_s);
      PatternMaps maps = make_pattern(options);
      if (from.kind == Pattern::waves) {
        auto motion = std::make_shared<ReliefMotion>();
        motion->sines.resize(static_cast<std::size_t>(options.waves));
        make_sines(options, motion->sines.data());
        motion->time_s = time_s;
        layer.motion = std::move(motion);
      }
      layer.heights = std::move(maps.heights);
      layer.colors = std::move(maps.colors);
    }
  }
  if (from.colors.width > 0) layer.colors = from.colors;
  layer.normal_map = from.normals.width > 0;
  layer.normals = layer.normal_map ? from.normals : slopes_of(layer.heights);
  return layer;
}

// The index rises from the ground's to that above: its square linearly, as far as the air is followed, or towards it
// exponentially; turbulence moves the profile up and down.
ReliefAir make_air(const ReliefAirDescription& from, double time_s) {
  ReliefAir air;
  air.height_m = static_cast<float>(from.height_m);
  air.size = glm::ivec3(from.texels);
  const double ground2 = from.ground_index * from.ground_index, above2 = from.index * from.index;
  air.index2.reserve(static_cast<std::size_t>(air.size.x) * static_cast<std::size_t>(air.size.y) *
                     static_cast<std::size_t>(air.size.z));
  constexpr int kPeriods = 4;
  for (int z = 0; z < air.size.z; ++z) {
    for (int y = 0; y < air.size.y; ++y) {
      for (int x = 0; x < air.size.x; ++x) {
        const double h = static_cast<double>(z) / (air.size.z - 1) * from.height_m;
        double moved = h;
        if (from.turbulence > 0) {
          // Seamless over u: two noises that run past each other.
          const glm::vec3 p(static_cast<float>(x) / static_cast<float>(air.size.x) * kPeriods,
                            static_cast<float>(y) / static_cast<float>(air.size.y) * kPeriods,
                            static_cast<float>(h / from.height_m * 2 - time_s));
          const auto seed = static_cast<std::uint32_t>(from.seed);
          const glm::vec3 q(static_cast<float>(kPeriods), 0.0F, 0.0F);
          const float wx = p.x / kPeriods;
          const float noise = glm::mix(gradient_noise(p, seed), gradient_noise(p - q, seed), wx);
          moved = std::max(0.0, h * (1 + from.turbulence * static_cast<double>(noise)));
        }
        const double share = from.exponential ? 1 - std::exp(-moved / from.falloff_m) : moved / from.height_m;
        air.index2.push_back(static_cast<float>(glm::mix(ground2, above2, share)));
      }
    }
  }
  return air;
}

void copy_shading(const ReliefLayerDescription& from, ReliefLayer& to) {
  to.albedo = glm::vec3(from.albedo);
  to.specular = static_cast<float>(from.specular);
  to.exponent = static_cast<float>(from.exponent);
}

}  // namespace

void evaluate_relief_maps(const SceneDescription& description, std::size_t index, double time_s, Scene& scene) {
  const ReliefDescription& from = description.reliefs[index];
  Relief& relief = scene.reliefs[index];
  relief.solid = make_layer(description, from, from.solid, "solid", nullptr, time_s);
  if (from.translucent)
    relief.translucent = make_layer(description, from, *from.translucent, "translucent", &relief.solid, time_s);
  if (from.air) relief.air = make_air(*from.air, time_s);
  ++relief.maps_revision;
  evaluate_relief(description, index, scene);
}

void evaluate_relief(const SceneDescription& description, std::size_t index, Scene& scene) {
  const ReliefDescription& from = description.reliefs[index];
  Relief& relief = scene.reliefs[index];
  relief.name = from.name;
  relief.tiling = glm::vec2(from.tiling);
  relief.cut = from.cut;
  relief.outside_index = static_cast<float>(from.outside_index);
  relief.index = static_cast<float>(from.index);
  relief.scattering = glm::vec3(from.scattering);
  relief.anisotropy = static_cast<float>(from.anisotropy);
  relief.intensification = static_cast<float>(from.intensification);
  // 1 − (1/2)^(d / d0) is the share that is absorbed over the path d (Timonen, Eq. 1).
  for (int c = 0; c < 3; ++c)
    relief.absorption[c] = static_cast<float>(std::numbers::ln2 / from.half_depth_m[c]);
  copy_shading(from.solid, relief.solid);
  if (relief.translucent) copy_shading(*from.translucent, *relief.translucent);
}

}  // namespace pellucid
