#include "algorithms/scene/shapes/forest_trees.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "algorithms/scene/noise.hpp"
#include "algorithms/scene/shapes/procedural.hpp"
#include "algorithms/scene/shapes/tree_parts.hpp"

namespace pellucid::forest {
namespace {

constexpr glm::vec3 kSpruceBark(0.085F, 0.062F, 0.047F);
constexpr glm::vec3 kPineBark(0.13F, 0.078F, 0.05F);
constexpr glm::vec3 kBeechBark(0.15F, 0.14F, 0.12F);
constexpr glm::vec3 kBirchBark(0.46F, 0.44F, 0.4F);
constexpr glm::vec3 kDeadWood(0.12F, 0.105F, 0.09F);
constexpr glm::vec3 kNeedlesInside(0.012F, 0.022F, 0.013F);
constexpr glm::vec3 kNeedles(0.04F, 0.08F, 0.038F);
constexpr glm::vec3 kPineNeedles(0.05F, 0.085F, 0.05F);
constexpr glm::vec3 kFern(0.09F, 0.13F, 0.03F);

// One of two numbers, by the detail.
template <class T>
T pick(Detail detail, T near, T far) {
  return detail == Detail::near ? near : far;
}

}  // namespace

Mesh make_spruce(std::uint32_t seed, Detail detail) {
  Mesh mesh;
  mesh.name = "spruce";
  Random random(seed, 1);
  const float height = 15.0F;
  const Stem trunk =
      make_trunk({height, 0.19F, 0.03F, 0.12F, pick(detail, 6, 4), kSpruceBark, kSpruceBark * 0.8F}, random);
  add_tube(mesh, trunk, pick(detail, 8, 4), 0.1F, random);
  add_whorls(mesh, trunk, height,
             {1.9F, 2.5F, pick(detail, 20, 13), pick(detail, 7, 6), pick(detail, 6, 2), kNeedlesInside, kNeedles},
             random);
  return mesh;
}

Mesh make_young_spruce(std::uint32_t seed, Detail detail) {
  Mesh mesh;
  mesh.name = "young_spruce";
  Random random(seed, 2);
  const float height = 4.0F;
  const Stem trunk = make_trunk({height, 0.05F, 0.012F, 0.06F, pick(detail, 4, 2), kSpruceBark, kSpruceBark}, random);
  add_tube(mesh, trunk, pick(detail, 6, 3), 0.1F, random);
  add_whorls(mesh, trunk, height,
             {0.35F, 1.25F, pick(detail, 12, 8), pick(detail, 8, 5), pick(detail, 6, 2), kNeedlesInside, kNeedles},
             random);
  return mesh;
}

Mesh make_pine(std::uint32_t seed, Detail detail) {
  Mesh mesh;
  mesh.name = "pine";
  Random random(seed, 3);
  const Stem trunk =
      make_trunk({18.0F, 0.23F, 0.06F, 0.3F, pick(detail, 8, 5), kPineBark * 0.75F, kPineBark * 1.25F}, random);
  add_tube(mesh, trunk, pick(detail, 9, 5), 0.09F, random);
  const int stubs = pick(detail, 9, 4);  // dead, below the crown
  for (int i = 0; i < stubs; ++i) {
    const float y = random.range(2.2F, 11.0F);
    const glm::vec3 out = random_direction(-0.3F, 0.25F, random);
    add_branch(mesh, point_on(trunk, y), out, random.range(0.35F, 1.3F), 0.02F, -0.02F, 2, 3, kDeadWood * 0.8F, random);
  }
  const int limbs = pick(detail, 15, 9);  // they carry tufts of needles
  for (int i = 0; i < limbs; ++i) {
    const float t = (static_cast<float>(i) + random.next()) / static_cast<float>(limbs);
    const float y = glm::mix(10.8F, 17.6F, t);
    const glm::vec3 out = heading(2.4F * static_cast<float>(i) + random.range(-0.4F, 0.4F));
    const float length = 2.6F * (1.0F - 0.5F * t) * random.range(0.7F, 1.2F);
    const Stem limb = add_branch(mesh, point_on(trunk, y), glm::normalize(out + 0.35F * kUp), length, 0.045F, 0.1F,
                                 pick(detail, 3, 2), 3, kPineBark, random);
    for (std::size_t k = 1; k < limb.path.size(); ++k) {
      for (int j = 0; j < 4; ++j) {
        const float size = random.range(0.55F, 0.95F) * pick(detail, 1.0F, 1.25F);
        add_bough(mesh,
                  {limb.path[k], heading(random.range(0.0F, kTurn)), size, 0.5F * size, random.range(0.1F, 0.8F), 0.35F,
                   pick(detail, 3, 2), kNeedlesInside, kPineNeedles * random.range(0.75F, 1.25F)},
                  random);
      }
    }
  }
  return mesh;
}

Mesh make_beech(std::uint32_t seed, Detail detail) {
  Mesh mesh;
  mesh.name = "beech";
  Random random(seed, 4);
  const float height = 15.0F;
  const Stem trunk =
      make_trunk({height, 0.2F, 0.015F, 0.45F, pick(detail, 9, 6), kBeechBark * 0.8F, kBeechBark}, random);
  add_tube(mesh, trunk, pick(detail, 9, 5), 0.08F, random);
  add_limbs(mesh, trunk, height,
            {3.2F, 4.2F, 0.75F, pick(detail, 17, 11), pick(detail, 3, 2), pick(detail, 4, 3), pick(detail, 5, 3),
             kBeechBark * 0.75F},
            random);
  return mesh;
}

Mesh make_birch(std::uint32_t seed, Detail detail) {
  Mesh mesh;
  mesh.name = "birch";
  Random random(seed, 5);
  const float height = 12.0F;
  Stem trunk = make_trunk({height, 0.1F, 0.01F, 0.5F, pick(detail, 14, 7), kBirchBark, kBirchBark * 0.6F}, random);
  for (std::size_t i = 2; i < trunk.color.size(); ++i) {  // dark scars
    if (random.next() < 0.35F) trunk.color[i] *= 0.3F;
  }
  add_tube(mesh, trunk, pick(detail, 7, 4), 0.05F, random);
  add_limbs(mesh, trunk, height,
            {3.0F, 2.4F, 1.0F, pick(detail, 15, 9), pick(detail, 2, 1), pick(detail, 4, 3), 3, kBirchBark * 0.35F},
            random);
  return mesh;
}

Mesh make_fern(std::uint32_t seed, Detail detail) {
  Mesh mesh;
  mesh.name = "fern";
  Random random(seed, 6);
  const int fronds = pick(detail, 9, 6);
  for (int i = 0; i < fronds; ++i) {
    const float spread = random.range(-0.35F, 0.35F);
    const float angle = kTurn * (static_cast<float>(i) + spread) / static_cast<float>(fronds);
    const float length = random.range(0.5F, 0.95F);
    add_bough(mesh,
              {{0.0F, -0.03F, 0.0F},
               heading(angle),
               length,
               0.2F * length,
               random.range(0.9F, 1.5F),
               random.range(0.7F, 1.2F),
               pick(detail, 7, 2),
               kFern * 0.25F,
               kFern * random.range(0.7F, 1.25F)},
              random);
  }
  return mesh;
}

Mesh make_rock(std::uint32_t seed, Detail detail) {
  Mesh mesh = make_sphere(1.0F, pick(detail, 14, 8));
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

Mesh make_fallen_trunk(std::uint32_t seed, Detail detail) {
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
  add_tube(mesh, trunk, pick(detail, 8, 5), 0.12F, random);
  for (int i = 0; i < 4; ++i) {
    const glm::vec3 out = random_direction(0.3F, 1.0F, random);
    const glm::vec3 base = trunk.path[static_cast<std::size_t>(1 + random.below(4))];
    add_branch(mesh, base, out, random.range(0.4F, 1.1F), 0.03F, 0.0F, 2, 3, kDeadWood * 0.7F, random);
  }
  return mesh;
}

}  // namespace pellucid::forest
