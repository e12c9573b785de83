#include "algorithms/scene/forest_trees.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "algorithms/scene/noise.hpp"
#include "algorithms/scene/procedural.hpp"

namespace pellucid::forest {
namespace {

constexpr float kTurn = 2.0F * std::numbers::pi_v<float>;
constexpr glm::vec3 kUp(0.0F, 1.0F, 0.0F);

constexpr glm::vec3 kSpruceBark(0.085F, 0.062F, 0.047F);
constexpr glm::vec3 kPineBark(0.13F, 0.078F, 0.05F);
constexpr glm::vec3 kBeechBark(0.15F, 0.14F, 0.12F);
constexpr glm::vec3 kBirchBark(0.46F, 0.44F, 0.4F);
constexpr glm::vec3 kDeadWood(0.12F, 0.105F, 0.09F);
constexpr glm::vec3 kMoss(0.06F, 0.095F, 0.025F);
constexpr glm::vec3 kNeedlesInside(0.012F, 0.022F, 0.013F);
constexpr glm::vec3 kNeedles(0.04F, 0.08F, 0.038F);
constexpr glm::vec3 kPineNeedles(0.05F, 0.085F, 0.05F);
constexpr glm::vec3 kFern(0.09F, 0.13F, 0.03F);

glm::vec3 heading(float angle) {
  return {std::cos(angle), 0.0F, -std::sin(angle)};
}

// Random numbers are drawn one statement at a time, or in braces: the order of evaluation of operands and arguments is
// the compiler's choice, and a seed must give the same forest with every compiler.
glm::vec3 random_direction(float min_rise, float max_rise, Random& random) {
  const glm::vec3 out = heading(random.range(0.0F, kTurn));
  return glm::normalize(out + kUp * random.range(min_rise, max_rise));
}

unsigned add_vertex(Mesh& mesh, const glm::vec3& position, const glm::vec3& normal, const glm::vec3& color) {
  mesh.positions.push_back(position);
  mesh.normals.push_back(normal);
  mesh.colors.push_back(color);
  return static_cast<unsigned>(mesh.positions.size()) - 1;
}

struct Stem {
  std::vector<glm::vec3> path;
  std::vector<float> radius;
  std::vector<glm::vec3> color;
  void add(const glm::vec3& p, float r, const glm::vec3& c) {
    path.push_back(p);
    radius.push_back(r);
    color.push_back(c);
  }
};

// A tube of `sides` around the stem; it ends in a point where the last radius is 0. `fluting` makes the cross-section
// irregular.
void add_tube(Mesh& mesh, const Stem& stem, int sides, float fluting, Random& random) {
  assert(stem.path.size() >= 2 && sides >= 3);
  const std::size_t rings = stem.path.size();
  std::vector<float> lobe(static_cast<std::size_t>(sides));
  for (float& l : lobe)
    l = 1.0F + fluting * random.range(-1.0F, 1.0F);
  const auto first = static_cast<unsigned>(mesh.positions.size());
  const auto n = static_cast<unsigned>(sides);
  for (std::size_t ring = 0; ring < rings; ++ring) {
    const glm::vec3 before = stem.path[ring == 0 ? 0 : ring - 1], after = stem.path[std::min(ring + 1, rings - 1)];
    const glm::vec3 axis = glm::normalize(after - before);
    const glm::vec3 helper = std::abs(axis.y) < 0.9F ? kUp : glm::vec3(1.0F, 0.0F, 0.0F);
    const glm::vec3 u = glm::normalize(glm::cross(helper, axis));
    const glm::vec3 v = glm::cross(axis, u);
    for (unsigned side = 0; side < n; ++side) {
      const float angle = kTurn * static_cast<float>(side) / static_cast<float>(n);
      const glm::vec3 normal = std::cos(angle) * u + std::sin(angle) * v;
      const float mottle = 1.0F + 1.2F * fluting * (lobe[(side + ring) % n] - 1.0F) / std::max(fluting, 1e-6F);
      add_vertex(mesh, stem.path[ring] + normal * (stem.radius[ring] * lobe[side]), normal, stem.color[ring] * mottle);
    }
  }
  for (std::size_t ring = 0; ring + 1 < rings; ++ring) {
    for (unsigned side = 0; side < n; ++side) {
      const unsigned a = first + static_cast<unsigned>(ring) * n + side;
      const unsigned b = first + static_cast<unsigned>(ring) * n + (side + 1) % n;
      mesh.triangles.emplace_back(a, b, b + n);
      if (stem.radius[ring + 1] > 0.0F) mesh.triangles.emplace_back(a, b + n, a + n);
    }
  }
}

// A trunk that flares at the root, tapers to `top_radius` and wanders sideways by `bend` metres.
Stem make_trunk(float height, float root_radius, float top_radius, float bend, int segments, const glm::vec3& bark,
                const glm::vec3& bark_above, Random& random) {
  Stem stem;
  const float phase = random.range(0.0F, kTurn), phase2 = random.range(0.0F, kTurn);
  const glm::vec3 along = heading(random.range(0.0F, kTurn));
  const glm::vec3 across(along.z, 0.0F, -along.x);
  const auto sideways = [&](float t) {
    const float sway = std::sin(2.6F * t + phase) - std::sin(phase),
                sway2 = std::sin(4.1F * t + phase2) - std::sin(phase2);
    return bend * (along * sway + 0.6F * across * sway2);
  };
  stem.add({0.0F, -0.25F, 0.0F}, root_radius * 1.75F, glm::mix(bark * 0.55F, kMoss * 0.6F, 0.5F));
  stem.add(sideways(0.25F / height) + glm::vec3(0.0F, 0.25F, 0.0F), root_radius * 1.2F,
           glm::mix(bark * 0.8F, kMoss, 0.35F));
  for (int i = 1; i <= segments; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(segments);
    const float y = 0.25F + (height - 0.25F) * t * (0.6F + 0.4F * t);
    const float s = y / height;
    stem.add(sideways(s) + glm::vec3(0.0F, y, 0.0F), glm::mix(root_radius, top_radius, std::pow(s, 0.8F)),
             glm::mix(bark, bark_above, s) * random.range(0.85F, 1.12F));
  }
  return stem;
}

glm::vec3 point_on(const Stem& stem, float y) {
  for (std::size_t i = 0; i + 1 < stem.path.size(); ++i) {
    const glm::vec3 &a = stem.path[i], &b = stem.path[i + 1];
    if (y <= b.y) return glm::mix(a, b, std::clamp((y - a.y) / (b.y - a.y), 0.0F, 1.0F));
  }
  return stem.path.back();
}

float radius_on(const Stem& stem, float y) {
  for (std::size_t i = 0; i + 1 < stem.path.size(); ++i) {
    const float a = stem.path[i].y, b = stem.path[i + 1].y;
    if (y <= b) return std::lerp(stem.radius[i], stem.radius[i + 1], std::clamp((y - a) / (b - a), 0.0F, 1.0F));
  }
  return stem.radius.back();
}

struct Bough {
  glm::vec3 base;
  glm::vec3 out;  // unit, horizontal
  float length;
  float width;
  float rise;   // slope at the base
  float droop;  // what the tip falls below the straight line, per length
  int teeth;    // pairs of side twigs
  glm::vec3 inside, outside;
};

// A flat spray of twigs: pairs of triangular teeth along a drooping spine, the gaps between them open, so that its
// outline is ragged. Normals lean outwards and up, as those of the whole crown.
void add_bough(Mesh& mesh, const Bough& b, Random& random) {
  const glm::vec3 side(b.out.z, 0.0F, -b.out.x);
  const auto spine = [&](float s) {
    return b.base + b.length * (b.out * (s * (1.0F - 0.15F * b.droop * s)) + kUp * (b.rise * s - b.droop * s * s));
  };
  const glm::vec3 crown = glm::normalize(0.55F * b.out + 0.8F * kUp);
  const auto tint = [&](float s) { return glm::mix(b.inside, b.outside, std::pow(s, 0.7F)); };
  const auto first = static_cast<unsigned>(mesh.positions.size());
  for (int i = 0; i <= b.teeth; ++i) {
    const float s = static_cast<float>(i) / static_cast<float>(b.teeth);
    add_vertex(mesh, spine(s), crown, tint(s));
  }
  for (int i = 0; i < b.teeth; ++i) {
    const float s = static_cast<float>(i) / static_cast<float>(b.teeth);
    const float step = 1.0F / static_cast<float>(b.teeth);
    for (const float hand : {-1.0F, 1.0F}) {
      const float reach = b.width * (1.0F - 0.72F * s) * random.range(0.7F, 1.2F);
      const float ahead = std::min(s + step * random.range(0.75F, 1.35F), 1.0F);
      const glm::vec3 tip = spine(ahead) + side * (hand * reach) - kUp * (reach * random.range(0.15F, 0.5F));
      const glm::vec3 normal = glm::normalize(crown + 0.45F * hand * side);
      const unsigned twig =
          add_vertex(mesh, tip, normal, tint(std::min(1.0F, 0.35F + ahead)) * random.range(0.8F, 1.2F));
      const unsigned a = first + static_cast<unsigned>(i), c = a + 1;
      if (hand > 0.0F) {
        mesh.triangles.emplace_back(a, twig, c);
      } else {
        mesh.triangles.emplace_back(a, c, twig);
      }
    }
  }
}

// Whorls of boughs from `low` to the tip, longest at the bottom; a fraction is missing or broken.
void add_whorls(Mesh& mesh, const Stem& trunk, float height, float low, float reach, int whorls, int boughs, int teeth,
                Random& random) {
  float turn = 0.0F;
  for (int w = 0; w < whorls; ++w) {
    const float t = static_cast<float>(w) / static_cast<float>(whorls - 1);
    const float y = glm::mix(low, 0.985F * height, std::pow(t, 0.92F));
    const float taper = std::pow(1.0F - (y - low) / (1.02F * height - low), 0.8F);
    turn += random.range(0.3F, 1.0F);
    const int count = t > 0.85F ? std::max(4, boughs - 2) : boughs;
    for (int i = 0; i < count; ++i) {
      if (t < 0.25F && random.next() < 0.28F) continue;
      const float angle =
          turn + kTurn * (static_cast<float>(i) + random.range(-0.3F, 0.3F)) / static_cast<float>(count);
      const float length = reach * taper * random.range(0.72F, 1.12F) + 0.06F;
      const float light = random.range(0.75F, 1.2F) * glm::mix(0.75F, 1.15F, t);
      add_bough(mesh,
                {point_on(trunk, y) + kUp * random.range(-0.12F, 0.12F), heading(angle), length, 0.42F * length + 0.05F,
                 glm::mix(0.05F, 0.75F, t * t), glm::mix(0.5F, 0.3F, t) * random.range(0.8F, 1.25F), teeth,
                 kNeedlesInside, kNeedles * light},
                random);
    }
  }
  Stem leader;
  leader.add(trunk.path.back(), trunk.radius.back(), kNeedles);
  leader.add(trunk.path.back() + glm::vec3(0.0F, 0.05F * height, 0.0F), 0.0F, kNeedles);
  add_tube(mesh, leader, 3, 0.0F, random);
}

// A curved branch; returns its stem, so that twigs can grow from it.
Stem add_branch(Mesh& mesh, const glm::vec3& base, const glm::vec3& direction, float length, float radius, float lift,
                int segments, int sides, const glm::vec3& bark, Random& random) {
  Stem stem;
  glm::vec3 p = base, d = direction;
  const float step = length / static_cast<float>(segments);
  for (int i = 0; i <= segments; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(segments);
    stem.add(p, i == segments ? 0.0F : radius * (1.0F - 0.85F * t), bark);
    const glm::vec3 wander{random.range(-1.0F, 1.0F), random.range(-1.0F, 1.0F), random.range(-1.0F, 1.0F)};
    d = glm::normalize(d + 0.22F * wander + kUp * lift);
    p += d * step;
  }
  add_tube(mesh, stem, sides, 0.05F, random);
  return stem;
}

// Leafless crown: limbs around the trunk from `low` up, each with twigs.
void add_limbs(Mesh& mesh, const Stem& trunk, float height, float low, int limbs, int twigs, float reach, float rise,
               const glm::vec3& bark, Random& random) {
  float angle = random.range(0.0F, kTurn);
  for (int i = 0; i < limbs; ++i) {
    const float t = (static_cast<float>(i) + random.next()) / static_cast<float>(limbs);
    const float y = glm::mix(low, 0.97F * height, t);
    angle += 2.4F + random.range(-0.5F, 0.5F);
    const glm::vec3 out = glm::normalize(heading(angle) + kUp * (rise * random.range(0.7F, 1.4F)));
    const float length = reach * (1.0F - 0.55F * t) * random.range(0.7F, 1.2F);
    const float thickness = std::min(0.55F * radius_on(trunk, y), 0.022F * length + 0.015F);
    const Stem limb = add_branch(mesh, point_on(trunk, y), out, length, thickness, 0.06F, 4, 4, bark, random);
    for (int k = 0; k < twigs; ++k) {
      const auto at = static_cast<std::size_t>(1 + random.below(3));
      const glm::vec3 along = glm::normalize(limb.path[at + 1] - limb.path[at]);
      const glm::vec3 aside{random.range(-1.0F, 1.0F), random.range(-0.3F, 1.0F), random.range(-1.0F, 1.0F)};
      add_branch(mesh, limb.path[at], glm::normalize(along + 0.9F * aside), 0.45F * length * random.range(0.6F, 1.2F),
                 0.5F * limb.radius[at], 0.08F, 2, 3, bark * 0.9F, random);
    }
  }
}

}  // namespace

Mesh make_spruce(std::uint32_t seed) {
  Mesh mesh;
  mesh.name = "spruce";
  Random random(seed, 1);
  const float height = 15.0F;
  const Stem trunk = make_trunk(height, 0.19F, 0.03F, 0.12F, 6, kSpruceBark, kSpruceBark * 0.8F, random);
  add_tube(mesh, trunk, 7, 0.1F, random);
  add_whorls(mesh, trunk, height, 1.9F, 2.5F, 19, 7, 3, random);
  return mesh;
}

Mesh make_young_spruce(std::uint32_t seed) {
  Mesh mesh;
  mesh.name = "young_spruce";
  Random random(seed, 2);
  const float height = 4.0F;
  const Stem trunk = make_trunk(height, 0.05F, 0.012F, 0.06F, 3, kSpruceBark, kSpruceBark, random);
  add_tube(mesh, trunk, 5, 0.1F, random);
  add_whorls(mesh, trunk, height, 0.35F, 1.25F, 10, 7, 3, random);
  return mesh;
}

Mesh make_pine(std::uint32_t seed) {
  Mesh mesh;
  mesh.name = "pine";
  Random random(seed, 3);
  const float height = 18.0F;
  const Stem trunk = make_trunk(height, 0.23F, 0.06F, 0.3F, 8, kPineBark * 0.75F, kPineBark * 1.25F, random);
  add_tube(mesh, trunk, 8, 0.09F, random);
  for (int i = 0; i < 9; ++i) {  // dead stubs below the crown
    const float y = random.range(2.2F, 11.0F);
    const glm::vec3 out = random_direction(-0.3F, 0.25F, random);
    add_branch(mesh, point_on(trunk, y), out, random.range(0.35F, 1.3F), 0.02F, -0.02F, 2, 3, kDeadWood * 0.8F, random);
  }
  for (int i = 0; i < 15; ++i) {  // limbs that carry tufts of needles
    const float t = (static_cast<float>(i) + random.next()) / 15.0F;
    const float y = glm::mix(10.8F, 17.6F, t);
    const glm::vec3 out = heading(2.4F * static_cast<float>(i) + random.range(-0.4F, 0.4F));
    const float length = 2.6F * (1.0F - 0.5F * t) * random.range(0.7F, 1.2F);
    const Stem limb = add_branch(mesh, point_on(trunk, y), glm::normalize(out + 0.35F * kUp), length, 0.045F, 0.1F, 3,
                                 3, kPineBark, random);
    for (std::size_t k = 1; k < limb.path.size(); ++k) {
      for (int j = 0; j < 4; ++j) {
        const float size = random.range(0.55F, 0.95F);
        add_bough(mesh,
                  {limb.path[k], heading(random.range(0.0F, kTurn)), size, 0.5F * size, random.range(0.1F, 0.8F), 0.35F,
                   2, kNeedlesInside, kPineNeedles * random.range(0.75F, 1.25F)},
                  random);
      }
    }
  }
  return mesh;
}

Mesh make_beech(std::uint32_t seed) {
  Mesh mesh;
  mesh.name = "beech";
  Random random(seed, 4);
  const float height = 15.0F;
  const Stem trunk = make_trunk(height, 0.2F, 0.015F, 0.45F, 9, kBeechBark * 0.8F, kBeechBark, random);
  add_tube(mesh, trunk, 8, 0.08F, random);
  add_limbs(mesh, trunk, height, 3.2F, 17, 3, 4.2F, 0.75F, kBeechBark * 0.75F, random);
  return mesh;
}

Mesh make_birch(std::uint32_t seed) {
  Mesh mesh;
  mesh.name = "birch";
  Random random(seed, 5);
  const float height = 12.0F;
  Stem trunk = make_trunk(height, 0.1F, 0.01F, 0.5F, 14, kBirchBark, kBirchBark * 0.6F, random);
  for (std::size_t i = 2; i < trunk.color.size(); ++i) {  // dark scars
    if (random.next() < 0.35F) trunk.color[i] *= 0.3F;
  }
  add_tube(mesh, trunk, 6, 0.05F, random);
  add_limbs(mesh, trunk, height, 3.0F, 15, 2, 2.4F, 1.0F, kBirchBark * 0.35F, random);
  return mesh;
}

Mesh make_fern(std::uint32_t seed) {
  Mesh mesh;
  mesh.name = "fern";
  Random random(seed, 6);
  const int fronds = 8;
  for (int i = 0; i < fronds; ++i) {
    const float angle = kTurn * (static_cast<float>(i) + random.range(-0.35F, 0.35F)) / static_cast<float>(fronds);
    const float length = random.range(0.5F, 0.95F);
    add_bough(mesh,
              {{0.0F, -0.03F, 0.0F},
               heading(angle),
               length,
               0.2F * length,
               random.range(0.9F, 1.5F),
               random.range(0.7F, 1.2F),
               4,
               kFern * 0.25F,
               kFern * random.range(0.7F, 1.25F)},
              random);
  }
  return mesh;
}

Mesh make_rock(std::uint32_t seed) {
  Mesh mesh = make_sphere(1.0F, 14);
  mesh.name = "rock";
  mesh.uvs.clear();
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3 direction = mesh.positions[i];
    const float radius = 0.42F * (1.0F + 0.5F * fractal_noise(1.7F * direction + glm::vec3(7.3F), 3, seed));
    mesh.positions[i] = direction * radius * glm::vec3(1.1F, 0.7F, 0.9F) + glm::vec3(0.0F, 0.04F, 0.0F);
    const float mossy = std::clamp(0.6F * direction.y + 0.7F * value_noise(4.0F * direction, seed), 0.0F, 1.0F);
    mesh.colors.push_back(glm::mix(glm::vec3(0.11F, 0.105F, 0.1F), kMoss, mossy));
  }
  // Normals of the displaced surface: the triangles' own, summed at each position (seams and poles repeat positions).
  std::vector<glm::vec3> normals(mesh.positions.size(), glm::vec3(0.0F));
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::vec3 n =
        glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
    for (int corner = 0; corner < 3; ++corner)
      normals[t[corner]] += n;
  }
  for (std::size_t i = 0; i < normals.size(); ++i) {
    glm::vec3 sum(0.0F);
    for (std::size_t j = 0; j < normals.size(); ++j) {
      if (mesh.positions[i] == mesh.positions[j]) sum += normals[j];
    }
    mesh.normals[i] = glm::normalize(sum);
  }
  return mesh;
}

Mesh make_fallen_trunk(std::uint32_t seed) {
  Mesh mesh;
  mesh.name = "fallen_trunk";
  Random random(seed, 7);
  Stem trunk;
  for (int i = 0; i <= 6; ++i) {
    const float t = static_cast<float>(i) / 6.0F;
    const float y = 0.12F + random.range(-0.03F, 0.05F);
    trunk.add({5.0F * (t - 0.5F), y, 0.25F * std::sin(2.0F * t)}, i == 6 ? 0.0F : glm::mix(0.2F, 0.11F, t),
              glm::mix(kDeadWood * 0.7F, kMoss, random.range(0.1F, 0.7F)));
  }
  add_tube(mesh, trunk, 8, 0.12F, random);
  for (int i = 0; i < 4; ++i) {
    const glm::vec3 out = random_direction(0.3F, 1.0F, random);
    const glm::vec3 base = trunk.path[static_cast<std::size_t>(1 + random.below(4))];
    add_branch(mesh, base, out, random.range(0.4F, 1.1F), 0.03F, 0.0F, 2, 3, kDeadWood * 0.7F, random);
  }
  return mesh;
}

}  // namespace pellucid::forest
