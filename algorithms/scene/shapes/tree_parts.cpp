#include "algorithms/scene/shapes/tree_parts.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace pellucid::forest {

glm::vec3 heading(float angle) {
  return {std::cos(angle), 0.0F, -std::sin(angle)};
}

glm::vec3 random_direction(float min_rise, float max_rise, Random& random) {
  const glm::vec3 out = heading(random.range(0.0F, kTurn));
  return glm::normalize(out + kUp * random.range(min_rise, max_rise));
}

namespace {

unsigned add_vertex(Mesh& mesh, const glm::vec3& position, const glm::vec3& normal, const glm::vec3& color) {
  mesh.positions.push_back(position);
  mesh.normals.push_back(normal);
  mesh.colors.push_back(color);
  return static_cast<unsigned>(mesh.positions.size()) - 1;
}

}  // namespace

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
      const float mottle = 1.0F + 1.2F * (lobe[(side + ring) % n] - 1.0F);
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

Stem make_trunk(const Trunk& t, Random& random) {
  Stem stem;
  const float phase = random.range(0.0F, kTurn), phase2 = random.range(0.0F, kTurn);
  const glm::vec3 along = heading(random.range(0.0F, kTurn));
  const glm::vec3 across(along.z, 0.0F, -along.x);
  const auto sideways = [&](float s) {
    const float sway = std::sin(2.6F * s + phase) - std::sin(phase);
    const float sway2 = std::sin(4.1F * s + phase2) - std::sin(phase2);
    return t.bend * (along * sway + 0.6F * across * sway2);
  };
  stem.add({0.0F, -0.25F, 0.0F}, t.root_radius * 1.75F, glm::mix(t.bark * 0.55F, kMoss * 0.6F, 0.5F));
  stem.add(sideways(0.25F / t.height) + glm::vec3(0.0F, 0.25F, 0.0F), t.root_radius * 1.2F,
           glm::mix(t.bark * 0.8F, kMoss, 0.35F));
  for (int i = 1; i <= t.segments; ++i) {
    const float u = static_cast<float>(i) / static_cast<float>(t.segments);
    const float y = 0.25F + (t.height - 0.25F) * u * (0.6F + 0.4F * u);  // closer rings near the root
    const float s = y / t.height;
    stem.add(sideways(s) + glm::vec3(0.0F, y, 0.0F), glm::mix(t.root_radius, t.top_radius, std::pow(s, 0.8F)),
             glm::mix(t.bark, t.bark_above, s) * random.range(0.85F, 1.12F));
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
      const float ahead = std::min(s + step * random.range(0.75F, 1.35F) * (b.teeth > 3 ? 1.5F : 1.0F), 1.0F);
      const glm::vec3 tip = spine(ahead) + side * (hand * reach) - kUp * (reach * random.range(0.15F, 0.5F));
      const glm::vec3 normal = glm::normalize(crown + 0.45F * hand * side);
      const unsigned twig =
          add_vertex(mesh, tip, normal, tint(std::min(1.0F, 0.35F + ahead)) * random.range(0.8F, 1.2F));
      // Where there are many teeth each reaches over the next.
      const unsigned a = first + static_cast<unsigned>(i);
      const unsigned c = first + static_cast<unsigned>(std::min(i + (b.teeth > 3 ? 2 : 1), b.teeth));
      if (hand > 0.0F) {
        mesh.triangles.emplace_back(a, twig, c);
      } else {
        mesh.triangles.emplace_back(a, c, twig);
      }
    }
  }
}

void add_whorls(Mesh& mesh, const Stem& trunk, float height, const Whorls& w, Random& random) {
  float turn = 0.0F;
  for (int level = 0; level < w.count; ++level) {
    const float t = static_cast<float>(level) / static_cast<float>(w.count - 1);
    const float y = glm::mix(w.low, 0.985F * height, std::pow(t, 0.92F));
    const float taper = std::pow(1.0F - (y - w.low) / (1.02F * height - w.low), 0.8F);
    turn += random.range(0.3F, 1.0F);
    const int count = t > 0.85F ? std::max(4, w.boughs - 2) : w.boughs;
    for (int i = 0; i < count; ++i) {
      if (t < 0.25F && random.next() < 0.28F) continue;  // the lowest die first
      const float spread = random.range(-0.3F, 0.3F);
      const float angle = turn + kTurn * (static_cast<float>(i) + spread) / static_cast<float>(count);
      const float length = w.reach * taper * random.range(0.72F, 1.12F) + 0.06F;
      const float light = random.range(0.75F, 1.2F) * glm::mix(0.75F, 1.15F, t);
      add_bough(mesh,
                {point_on(trunk, y) + kUp * random.range(-0.12F, 0.12F), heading(angle), length, 0.42F * length + 0.05F,
                 glm::mix(0.05F, 0.75F, t * t), glm::mix(0.5F, 0.3F, t) * random.range(0.8F, 1.25F), w.teeth, w.inside,
                 w.outside * light},
                random);
    }
  }
  Stem leader;
  leader.add(trunk.path.back(), trunk.radius.back(), w.outside);
  leader.add(trunk.path.back() + glm::vec3(0.0F, 0.05F * height, 0.0F), 0.0F, w.outside);
  add_tube(mesh, leader, 3, 0.0F, random);
}

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

void add_limbs(Mesh& mesh, const Stem& trunk, float height, const Limbs& l, Random& random) {
  float angle = random.range(0.0F, kTurn);
  for (int i = 0; i < l.count; ++i) {
    const float t = (static_cast<float>(i) + random.next()) / static_cast<float>(l.count);
    const float y = glm::mix(l.low, 0.97F * height, t);
    angle += 2.4F + random.range(-0.5F, 0.5F);
    const glm::vec3 out = glm::normalize(heading(angle) + kUp * (l.rise * random.range(0.7F, 1.4F)));
    const float length = l.reach * (1.0F - 0.55F * t) * random.range(0.7F, 1.2F);
    const float thickness = std::min(0.55F * radius_on(trunk, y), 0.022F * length + 0.015F);
    const Stem limb =
        add_branch(mesh, point_on(trunk, y), out, length, thickness, 0.06F, l.segments, l.sides, l.bark, random);
    for (int k = 0; k < l.twigs; ++k) {
      const auto at = static_cast<std::size_t>(1 + random.below(l.segments - 1));
      const glm::vec3 along = glm::normalize(limb.path[at + 1] - limb.path[at]);
      const glm::vec3 aside{random.range(-1.0F, 1.0F), random.range(-0.3F, 1.0F), random.range(-1.0F, 1.0F)};
      add_branch(mesh, limb.path[at], glm::normalize(along + 0.9F * aside), 0.45F * length * random.range(0.6F, 1.2F),
                 0.5F * limb.radius[at], 0.08F, l.segments / 2, 3, l.bark * 0.9F, random);
    }
  }
}

}  // namespace pellucid::forest
