#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <glm/glm.hpp>

#include "algorithms/geocube/search.hpp"

/// The exit of a ray by a multilayer geocube, which Chan and Wang 2005 leave to future work (Sec. 5). Layers begin and
/// end between neighbouring texels, so that no layer can be interpolated by its number; what is interpolated is how far
/// a point lies inside. GLSL twin: layers.glsl.
namespace pellucid::geocube {

/// The layers of a set's cubes, texel by texel.
class LayerMaps {
 public:
  explicit LayerMaps(const CubeSet& set) : set_(&set), grid_(set.grid()) {}
  const CubeGrid& grid() const { return grid_; }
  int layers() const { return set_->options.layers; }
  glm::vec3 center(int cube) const { return glm::vec3(cube_at(cube).center); }
  float sphere(int cube) const { return cube_at(cube).sphere; }
  const glm::vec4& bounds(int cube, int layer, std::size_t texel) const { return at(cube, layer).bounds[texel]; }
  const glm::vec4& plane(int cube, int layer, std::size_t texel) const { return at(cube, layer).planes[texel]; }
  glm::vec4 inner(int cube, int layer, std::size_t texel) const {
    return layer > 0 ? at(cube, layer).inners[texel] : glm::vec4(0.0F);
  }

 private:
  const Cube& cube_at(int cube) const { return set_->cubes[static_cast<std::size_t>(cube)]; }
  const CubeLayer& at(int cube, int layer) const { return cube_at(cube).layers[static_cast<std::size_t>(layer)]; }
  const CubeSet* set_;
  CubeGrid grid_;
};

/// Where a point lies among a texel's layers.
struct Place {
  float depth = -kFar;  ///< distance along the radius to the nearest end of the nearest interval; below 0 outside
  int layer = 0;
  bool outer = true;  ///< that end is the outer one
};
inline Place place_in(const LayerMaps& maps, int cube, std::size_t texel, float l) {
  Place best;
  for (int k = 0; k < maps.layers(); ++k) {
    const float d = maps.bounds(cube, k, texel).x;
    if (d <= 0.0F) break;
    const float to_outer = d - l, to_inner = k == 0 ? kFar : l - maps.plane(cube, k, texel).w;
    const float depth = std::min(to_outer, to_inner);
    if (depth > best.depth) best = {depth, k, to_outer <= to_inner};
  }
  return best;
}

/// How far a point is inside, and the surface's normal there, from the four texels about its direction.
struct Field {
  float depth = 0;
  glm::vec3 normal{0.0F};   ///< not unit
  std::size_t nearest = 0;  ///< texel
  Place place;              ///< in it
};
inline Field field_at(const LayerMaps& maps, int cube, const glm::vec3& v, float l) {
  const CubeGrid::Sample at = maps.grid().sample(glm::dvec3(v));
  // A far end must not outweigh a near one.
  const float most = 8.0F / static_cast<float>(maps.grid().n()) * l;
  Field field;
  double largest = -1;
  for (std::size_t i = 0; i < 4; ++i) {
    if (at.weight[i] <= 0) continue;
    const Place place = place_in(maps, cube, at.index[i], l);
    const auto weight = static_cast<float>(at.weight[i]);
    field.depth += weight * std::clamp(place.depth, -most, most);
    field.normal += weight * glm::vec3(place.outer ? maps.plane(cube, place.layer, at.index[i])
                                                   : maps.inner(cube, place.layer, at.index[i]));
    if (at.weight[i] <= largest) continue;
    largest = at.weight[i];
    field.nearest = at.index[i];
    field.place = place;
  }
  return field;
}

/// The step that the texel's cones allow inside its interval.
inline float allowed_layer_step(const LayerMaps& maps, int cube, const Field& field, const glm::vec3& v, float l,
                                const glm::vec3& h) {
  const int k = field.place.layer;
  const glm::vec4 bounds = maps.bounds(cube, k, field.nearest), plane = maps.plane(cube, k, field.nearest);
  if (k == 0) return allowed_step({bounds, plane}, v, l, h);
  const float d = bounds.x, from = plane.w, hv = glm::dot(h, v);
  // Cones A from either end to the middle.
  const float half = std::max(0.5F * (d - from), 1e-20F), middle = 0.5F * (d + from);
  const float a = l > middle ? half * cone_step((l - middle) / half, -hv, -hv, 1.0F, bounds.y)
                             : half * cone_step((middle - l) / half, hv, hv, 1.0F, bounds.y);
  // Cone B between the tangent planes.
  float b = l * cone_wall(bounds.z, -hv);
  const glm::vec3 n(plane), inner_n(maps.inner(cube, k, field.nearest));
  const float out = glm::dot(h, n), in = glm::dot(h, inner_n);
  if (out > 0.0F) b = std::min(b, (d - l) * glm::dot(v, n) / out);
  if (in > 0.0F) b = std::min(b, (from - l) * glm::dot(v, inner_n) / in);
  const float step = std::max(a < kFar ? a : 0.0F, b < kFar ? b : 0.0F);
  return std::min(step, 2.0F * d);
}

/// As find_exit(), in one cube of many layers.
inline Exit find_exit_in_layers(const LayerMaps& maps, const glm::vec3& p, const glm::vec3& normal, const glm::vec3& h,
                                int cube, const SearchOptions& options) {
  const glm::vec3 o = maps.center(cube);
  float t = options.min_step;
  if (-glm::dot(h, normal) >= options.cosine_c - 1e-4F) {
    // The texel's surface that is nearest to p is the one.
    const std::size_t texel = maps.grid().index(maps.grid().nearest(glm::dvec3(p - o)));
    const float l = glm::length(p - o);
    float least = kFar, radius = 0;
    for (int k = 0; k < maps.layers(); ++k) {
      const glm::vec4 bounds = maps.bounds(cube, k, texel);
      if (bounds.x <= 0.0F) break;
      const float outer = std::abs(bounds.x - l), inner = k == 0 ? kFar : std::abs(maps.plane(cube, k, texel).w - l);
      if (std::min(outer, inner) >= least) continue;
      least = std::min(outer, inner);
      radius = outer <= inner ? bounds.w : maps.inner(cube, k, texel).w;
    }
    t = std::max(t, radius);
  }
  Exit exit;
  exit.cube = cube;
  float inside = 0, depth_inside = options.min_step, outside = kFar, depth_outside = 0;
  bool found = false;
  Field field;
  while (!found && exit.steps < options.iterations) {
    ++exit.steps;
    const glm::vec3 w = p + t * h - o;
    const float l = std::max(glm::length(w), 1e-20F);
    const glm::vec3 v = w / l;
    if (l < maps.sphere(cube)) {
      inside = t;
      depth_inside = maps.sphere(cube) - l;
      t += std::max(maps.sphere(cube) * sphere_step(l / maps.sphere(cube), glm::dot(h, v)), options.min_step);
      continue;
    }
    field = field_at(maps, cube, v, l);
    if (field.depth > 0.0F) {
      inside = t;
      depth_inside = field.depth;
      const float step = field.place.depth > 0.0F ? allowed_layer_step(maps, cube, field, v, l, h) : 0.0F;
      t += std::max(step, options.min_step);
      continue;
    }
    found = glm::dot(h, field.normal) > 0.0F;
    outside = t;
    depth_outside = field.depth;
    if (!found) t += options.min_step;
  }
  exit.bounded = !found;
  // False position, since the field has no plane of its own.
  for (int k = 0; found && k < 2 * options.refine; ++k) {
    const float share = depth_inside / std::max(depth_inside - depth_outside, 1e-20F);
    t = inside + std::clamp(share, 0.02F, 0.98F) * (outside - inside);
    const glm::vec3 w = p + t * h - o;
    const float l = std::max(glm::length(w), 1e-20F);
    field = field_at(maps, cube, w / l, l);
    if (field.depth > 0.0F) {
      inside = t;
      depth_inside = field.depth;
    } else {
      outside = t;
      depth_outside = field.depth;
    }
  }
  exit.point = p + t * h;
  exit.length = t;
  exit.normal = leaving_normal(field.normal, h);
  return exit;
}

}  // namespace pellucid::geocube
