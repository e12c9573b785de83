#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "algorithms/scene/noise.hpp"
#include "algorithms/scene/shapes/forest_trees.hpp"
#include "algorithms/scene/shapes/procedural.hpp"
#include "gl/error.hpp"

namespace pellucid {
namespace {

constexpr float kTurn = 2.0F * std::numbers::pi_v<float>;
constexpr float kUndulation_m = 16.0F;  // period of the ground's largest waves

constexpr float kNear_m = 10.0F;  // from the clearing's edge: finer meshes are used up to here

// Streams of one seed, so that more trees leave the ferns where they were.
enum Stream : std::uint32_t { kPlaces = 11, kKinds = 12, kUndergrowth = 13 };

glm::vec3 ground_color(const ForestOptions& options, float x, float z, float height) {
  const float patches = fractal_noise({x / 4.5F, 3.5F, z / 4.5F}, 4, options.seed + 71U);
  const float grain = fractal_noise({x / 0.7F, 9.5F, z / 0.7F}, 2, options.seed + 72U);
  const glm::vec3 moss(0.062F, 0.095F, 0.026F), litter(0.125F, 0.084F, 0.044F), soil(0.06F, 0.046F, 0.033F);
  // Moss keeps to the hollows, litter to the ridges.
  const float dry = std::clamp(0.5F + 1.6F * patches + 0.25F * height, 0.0F, 1.0F);
  const glm::vec3 cover = glm::mix(moss, litter, dry * dry * (3.0F - 2.0F * dry));
  const float bare = std::clamp(1.4F * (grain - 0.15F), 0.0F, 0.7F);
  return glm::mix(cover, soil, bare) * (1.0F + 0.55F * grain);
}

Mesh make_ground(const ForestOptions& options) {
  // About half a metre between vertices, within what a software rasteriser draws quickly.
  const int segments =
      std::clamp(static_cast<int>(std::ceil(2.0F * std::max(options.extent.x, options.extent.y))), 8, 96);
  Mesh mesh = make_plane(options.extent, segments);
  mesh.name = "forest_ground";
  mesh.uvs.clear();
  mesh.colors.reserve(mesh.positions.size());
  const float h = 0.25F;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    glm::vec3& p = mesh.positions[i];
    p.y = forest_ground_height(options, p.x, p.z);
    const float dx = forest_ground_height(options, p.x + h, p.z) - forest_ground_height(options, p.x - h, p.z);
    const float dz = forest_ground_height(options, p.x, p.z + h) - forest_ground_height(options, p.x, p.z - h);
    mesh.normals[i] = glm::normalize(glm::vec3(-dx, 2.0F * h, -dz));
    mesh.colors.push_back(ground_color(options, p.x, p.z, p.y));
  }
  return mesh;
}

// Remembers where trunks stand, in cells as wide as the distance they keep.
class Stand {
 public:
  Stand(const glm::vec2& extent, float distance)
      : half_(0.5F * extent),
        distance_(distance),
        columns_(static_cast<int>(extent.x / distance) + 1),
        rows_(static_cast<int>(extent.y / distance) + 1),
        cells_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {}

  bool crowded(const glm::vec2& p, float distance) const {
    const glm::ivec2 c = cell(p);
    for (int row = std::max(c.y - 1, 0); row <= std::min(c.y + 1, rows_ - 1); ++row) {
      for (int column = std::max(c.x - 1, 0); column <= std::min(c.x + 1, columns_ - 1); ++column) {
        for (const glm::vec2& q : cells_[index(column, row)]) {
          if (glm::distance(p, q) < distance) return true;
        }
      }
    }
    return false;
  }
  void add(const glm::vec2& p) {
    const glm::ivec2 c = cell(p);
    cells_[index(c.x, c.y)].push_back(p);
  }

 private:
  glm::ivec2 cell(const glm::vec2& p) const {
    const glm::ivec2 c((p + half_) / distance_);
    return glm::clamp(c, glm::ivec2(0), glm::ivec2(columns_ - 1, rows_ - 1));
  }
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  glm::vec2 half_;
  float distance_;
  int columns_, rows_;
  std::vector<std::vector<glm::vec2>> cells_;
};

// A random place on the ground, off its edge and outside the clearing.
glm::vec2 random_place(const ForestOptions& options, float clearing_radius, Random& random) {
  for (int attempt = 0; attempt < 10000; ++attempt) {
    const glm::vec2 p = 0.495F * options.extent * glm::vec2{random.range(-1.0F, 1.0F), random.range(-1.0F, 1.0F)};
    if (glm::distance(p, options.clearing) > clearing_radius) return p;
  }
  throw InputError(fmt::format("forest: a clearing of radius {} m leaves no room for trees on a ground of {} x {} m",
                               options.clearing_radius, options.extent.x, options.extent.y));
}

// Dart throwing: trunks keep a distance that fits their number and shrinks where no place is left.
std::vector<glm::vec2> tree_places(const ForestOptions& options) {
  std::vector<glm::vec2> places;
  if (options.trees == 0) return places;
  Random random(options.seed, kPlaces);
  const float area = options.extent.x * options.extent.y;
  const float spacing = 0.62F * std::sqrt(area / static_cast<float>(options.trees));
  Stand stand(options.extent, spacing);
  while (places.size() < static_cast<std::size_t>(options.trees)) {
    glm::vec2 p{0.0F};
    float distance = spacing;
    do {
      p = random_place(options, options.clearing_radius, random);
      // Trees keep company: they stand closer where the noise is high.
      const float thinning = 1.0F - 0.55F * value_noise({p.x / 9.0F, 0.5F, p.y / 9.0F}, options.seed + 73U);
      if (!stand.crowded(p, distance * thinning)) break;
      distance *= 0.97F;
    } while (true);
    stand.add(p);
    places.push_back(p);
  }
  return places;
}

glm::mat4 plant(const ForestOptions& options, const glm::vec2& place, float sink, float turn, float lean,
                const glm::vec3& scale) {
  const float y = forest_ground_height(options, place.x, place.y) - sink;
  glm::mat4 m = glm::translate(glm::mat4(1.0F), {place.x, y, place.y});
  m = glm::rotate(m, turn, {0.0F, 1.0F, 0.0F});
  m = glm::rotate(m, lean, {1.0F, 0.0F, 0.0F});
  return glm::scale(m, scale);
}

struct Kind {
  Mesh (*make)(std::uint32_t seed, forest::Detail);
  int variants;
  float share;       // of all plants
  float share_near;  // beside the clearing, where low boughs would hide the view
  float min_scale, max_scale;
};
constexpr std::array<Kind, 5> kTrees = {{{forest::make_spruce, 2, 0.36F, 0.1F, 0.6F, 1.1F},
                                         {forest::make_young_spruce, 1, 0.14F, 0.06F, 0.5F, 1.3F},
                                         {forest::make_pine, 2, 0.26F, 0.44F, 0.75F, 1.15F},
                                         {forest::make_beech, 2, 0.15F, 0.26F, 0.7F, 1.1F},
                                         {forest::make_birch, 1, 0.09F, 0.14F, 0.7F, 1.15F}}};
constexpr std::array<Kind, 3> kUnderTrees = {{{forest::make_fern, 2, 0.86F, 0.86F, 0.5F, 1.5F},
                                              {forest::make_rock, 1, 0.09F, 0.09F, 0.4F, 1.6F},
                                              {forest::make_fallen_trunk, 1, 0.05F, 0.05F, 0.6F, 1.3F}}};

// Where the meshes of a kind begin: its variants near, then the same far.
struct FirstMesh {
  int near, far;
};

template <std::size_t N>
std::array<FirstMesh, N> add_meshes(Scene& scene, const std::array<Kind, N>& kinds, std::uint32_t seed) {
  std::array<FirstMesh, N> first{};
  for (std::size_t k = 0; k < N; ++k) {
    const int begin = static_cast<int>(scene.meshes.size());
    first[k] = {begin, begin + kinds[k].variants};
    for (const forest::Detail detail : {forest::Detail::near, forest::Detail::far}) {
      for (int variant = 0; variant < kinds[k].variants; ++variant) {
        Mesh mesh = kinds[k].make(seed * 977U + static_cast<std::uint32_t>(variant), detail);
        mesh.name = fmt::format("forest_{}_{}_{}", mesh.name, variant, detail == forest::Detail::near ? "near" : "far");
        scene.meshes.push_back(std::move(mesh));
      }
    }
  }
  return first;
}

template <std::size_t N>
std::size_t choose(const std::array<Kind, N>& kinds, float near, float u) {
  for (std::size_t k = 0; k + 1 < N; ++k) {
    const float share = std::lerp(kinds[k].share, kinds[k].share_near, near);
    if (u < share) return k;
    u -= share;
  }
  return N - 1;
}

}  // namespace

float forest_ground_height(const ForestOptions& options, float x, float z) {
  const glm::vec3 p(x / kUndulation_m, 0.5F, z / kUndulation_m);
  return 0.9F * options.relief_m * fractal_noise(p, 4, options.seed + 70U);
}

void add_forest(Scene& scene, const ForestOptions& options) {
  assert(options.extent.x > 0.0F && options.extent.y > 0.0F && options.trees >= 0 && options.undergrowth >= 0.0F);
  const int ground_material = static_cast<int>(scene.materials.size());
  scene.materials.push_back({"forest_ground", glm::vec3(1.0F), glm::vec3(0.0F)});
  scene.materials.push_back({"forest_plants", glm::vec3(1.0F), glm::vec3(0.0F)});
  const int ground_mesh = static_cast<int>(scene.meshes.size());
  scene.meshes.push_back(make_ground(options));
  scene.instances.push_back({"ground", ground_mesh, ground_material, glm::mat4(1.0F), glm::vec3(1.0F)});

  const auto add_plant = [&](std::string name, const Kind& kind, const FirstMesh& meshes, const glm::vec2& place,
                             float sink, float max_lean, Random& random) {
    const bool near = glm::distance(place, options.clearing) < options.clearing_radius + kNear_m;
    const float scale = random.range(kind.min_scale, kind.max_scale);
    const glm::vec3 girth{scale * random.range(0.88F, 1.12F), scale, scale * random.range(0.88F, 1.12F)};
    const float turn = random.range(0.0F, kTurn), lean = random.range(-max_lean, max_lean);
    const float light = random.range(0.75F, 1.2F), warmth = random.range(-0.12F, 0.12F);
    scene.instances.push_back({std::move(name), (near ? meshes.near : meshes.far) + random.below(kind.variants),
                               ground_material + 1, plant(options, place, sink, turn, lean, girth),
                               light * glm::vec3(1.0F + warmth, 1.0F, 1.0F - warmth)});
  };

  const std::array<FirstMesh, kTrees.size()> tree_meshes = add_meshes(scene, kTrees, options.seed);
  Random kinds(options.seed, kKinds);
  int number = 0;
  for (const glm::vec2& place : tree_places(options)) {
    const float distance = glm::distance(place, options.clearing) - options.clearing_radius;
    const float near = std::clamp(1.0F - (distance - 2.0F) / 8.0F, 0.0F, 1.0F);
    const std::size_t kind = choose(kTrees, near, kinds.next());
    add_plant(fmt::format("tree_{}", number++), kTrees[kind], tree_meshes[kind], place, 0.05F, 0.05F, kinds);
  }

  const std::array<FirstMesh, kUnderTrees.size()> under_meshes = add_meshes(scene, kUnderTrees, options.seed);
  Random random(options.seed, kUndergrowth);
  const int plants = static_cast<int>(options.undergrowth * static_cast<float>(options.trees));
  for (int i = 0; i < plants; ++i) {
    const std::size_t kind = choose(kUnderTrees, 0.0F, random.next());
    // Ferns grow in patches: of four places take the one where the noise is highest. The clearing keeps its edge only.
    glm::vec2 place{0.0F};
    float best = -1.0F;
    for (int candidate = 0; candidate < 4; ++candidate) {
      const glm::vec2 p = random_place(options, 0.5F * options.clearing_radius, random);
      const float wet = value_noise({p.x / 5.0F, 0.5F, p.y / 5.0F}, options.seed + 74U);
      if (wet > best) {
        best = wet;
        place = p;
      }
    }
    add_plant(fmt::format("undergrowth_{}", i), kUnderTrees[kind], under_meshes[kind], place, 0.02F, 0.1F, random);
  }
}

}  // namespace pellucid
