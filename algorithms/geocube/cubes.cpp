#include "algorithms/geocube/cubes.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "algorithms/geocube/cones/bound_search.hpp"
#include "algorithms/geocube/weld.hpp"
#include "algorithms/progress.hpp"
#include "gl/error.hpp"

namespace pellucid::geocube {
namespace {

constexpr int kMaxCrossings = 256;  // along one direction; a mesh with more is noise

struct Crossing {
  double distance = 0;
  std::uint32_t triangle = kNoTriangle;
  glm::dvec3 normal{0.0};
};

/// The ends of the inside's intervals by layer and texel.
struct Radial {
  struct Layer {
    std::vector<Crossing> outer, inner;
  };
  std::vector<Layer> layers;
  std::vector<char> again;  // by texel: of a single layer, the inside begins again behind it
  std::size_t dropped = 0;
};

void check(const CubeOptions& o) {
  if (o.resolution < 8 || o.resolution > 512)
    throw InputError(fmt::format("geocube: resolution = {} is out of range [8, 512]", o.resolution));
  if (o.layers < 1 || o.layers > 8)
    throw InputError(fmt::format("geocube: layers = {} is out of range [1, 8]", o.layers));
  if (!(o.epsilon > 0)) throw InputError(fmt::format("geocube: epsilon = {} is not above 0", o.epsilon));
  if (!(o.ior > 0)) throw InputError(fmt::format("geocube: an index of refraction of {} is not above 0", o.ior));
}

void check(const Solid& solid, std::span<const glm::dvec3> centers) {
  if (centers.empty()) throw InputError("geocube: no cube centre");
  if (centers.size() > kMaxCubes)
    throw InputError(fmt::format("geocube: {} cubes; at most {} are possible", centers.size(), kMaxCubes));
  for (std::size_t i = 0; i < centers.size(); ++i) {
    const glm::dvec3& c = centers[i];
    const bool inside = solid.contains(c);
    if (inside && solid.tree().nearest(c).distance > 1e-6 * solid.diagonal()) continue;
    throw InputError(fmt::format("geocube: the centre of cube {}, {}, lies {} mesh '{}' (which reaches from {} to {})",
                                 i + 1, place(c), inside ? "on the surface of" : "outside", solid.name(),
                                 place(solid.low()), place(solid.high())));
  }
}

// The surface along one direction from inside: out, in, out … A ray through an edge may miss or double a crossing;
// those that do not alternate are left out.
void trace(const Solid& solid, const glm::dvec3& center, const glm::dvec3& direction, std::size_t texel, Radial& radial,
           std::atomic<std::size_t>& dropped) {
  const auto layers = radial.layers.size();
  std::size_t layer = 0;
  bool inside = true;
  double begin = 0;
  glm::dvec3 turned = direction;
  const double nudge = 1e-6 * solid.diagonal();
  for (int k = 0; k < kMaxCrossings; ++k) {
    const auto hit = solid.first_hit(center, turned, begin);
    if (!hit) {
      if (!inside || layer > 0) break;
      // Through a crack between two triangles: look beside it.
      turned = glm::normalize(direction + 1e-5 * (k + 1) * glm::dvec3(0.6, -0.7, 0.4));
      if (k < 8) continue;
      throw RuntimeError(
          fmt::format("geocube: a ray from {} leaves mesh '{}' without meeting it", place(center), solid.name()));
    }
    begin = std::max(hit->distance, begin) + nudge;
    if (hit->leaves != inside) continue;
    const Crossing crossing{hit->distance, hit->triangle, solid.shading_normal(hit->triangle, hit->weights)};
    if (inside) {
      radial.layers[layer].outer[texel] = crossing;
      ++layer;
    } else {
      if (layer == layers) {
        if (layers == 1)
          radial.again[texel] = 1;
        else
          dropped.fetch_add(1, std::memory_order_relaxed);
        return;
      }
      radial.layers[layer].inner[texel] = crossing;
    }
    inside = !inside;
  }
  // An interval that never ends (only through a crack) is none.
  if (inside && layer < layers) radial.layers[layer].inner[texel] = {};
}

Radial trace_all(const Solid& solid, const glm::dvec3& center, const CubeGrid& grid, int layers) {
  Radial radial;
  radial.layers.resize(static_cast<std::size_t>(layers));
  for (auto& layer : radial.layers) {
    layer.outer.resize(grid.texels());
    layer.inner.resize(grid.texels());
  }
  radial.again.resize(grid.texels());
  std::atomic<std::size_t> dropped{0};
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, grid.texels(), 1024), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i)
      trace(solid, center, grid.direction(i), i, radial, dropped);
  });
  radial.dropped = dropped;
  return radial;
}

Sheet sheet_of(const std::vector<Crossing>& crossings, const CubeGrid& grid) {
  Sheet sheet;
  sheet.points.resize(grid.texels());
  sheet.present.resize(grid.texels());
  for (std::size_t i = 0; i < grid.texels(); ++i) {
    sheet.present[i] = crossings[i].triangle != kNoTriangle;
    sheet.points[i] = crossings[i].distance * grid.direction(i);
  }
  return sheet;
}

/// Works out the cones of one cube.
class ConeSearches {
 public:
  ConeSearches(const Solid& solid, const glm::dvec3& center, const CubeOptions& options, const Radial& radial,
               const SheetTree& directions)
      : solid_(solid),
        center_(center),
        options_(options),
        radial_(radial),
        directions_(directions),
        grid_(options.resolution) {
    for (const auto& layer : radial.layers)
      outer_.emplace_back(grid_, sheet_of(layer.outer, grid_));
    for (std::size_t k = 1; k < radial.layers.size(); ++k)
      inner_.emplace_back(grid_, sheet_of(radial.layers[k].inner, grid_));
    nearest_only_ = {&outer_[0]};
    for (const SheetTree& tree : outer_)
      all_.push_back(&tree);
    for (const SheetTree& tree : inner_)
      all_.push_back(&tree);
    sine_c_ = std::min(1.0, 1 / options.ior);
    cosine_c_ = std::sqrt(std::max(0.0, 1 - sine_c_ * sine_c_));
  }

  /// `work` names it to whoever waits.
  void fill(Cube& cube, const std::string& work) {
    const auto rows = static_cast<std::size_t>(6 * grid_.n()), n = static_cast<std::size_t>(grid_.n());
    for (std::size_t k = 0; k < radial_.layers.size(); ++k) {
      cube.layers.emplace_back();
      CubeLayer& layer = cube.layers.back();
      layer.bounds.assign(grid_.texels(), {0, 1, 1, 0});
      layer.planes.assign(grid_.texels(), glm::vec4(0.0F));
      if (k > 0) layer.inners.assign(grid_.texels(), glm::vec4(0.0F));
      // By single rows, so that no core is left with the dear ones at the end.
      const tbb::blocked_range<std::size_t> all_rows(0, rows, 1);
      std::atomic<std::size_t> done{0};
      tbb::parallel_for(
          all_rows,
          [&](const auto& range) {
            for (std::size_t row = range.begin(); row != range.end(); ++row) {
              Hints hints;
              hints.a = hints.b = row * n;
              for (std::size_t x = 0; x < n; ++x)
                fill(layer, k, row * n + x, hints);
              const std::size_t finished = k * rows + ++done;
              tell_progress(work, static_cast<double>(finished) / static_cast<double>(rows * radial_.layers.size()));
            }
          },
          tbb::simple_partitioner());
    }
  }

 private:
  struct Hints {
    std::size_t a = 0, b = 0;
    std::uint32_t c = kNoTriangle;
  };

  void fill(CubeLayer& layer, std::size_t k, std::size_t texel, Hints& hints) const {
    const Crossing &outer = radial_.layers[k].outer[texel], &inner = radial_.layers[k].inner[texel];
    if (outer.triangle == kNoTriangle) return;
    const glm::dvec3 v = grid_.direction(texel), s = outer.distance * v;
    double a = 1, b = 1, c = 0;
    if (options_.use_a) {
      a = k == 0 ? cone_a_cosine({s, -v, outer.distance}, nearest_only_, hints.a)
                 : cones_between(inner.distance, outer.distance, v, hints.a);
    }
    if (options_.use_b) {
      b = cone_b(outer, v, outer_[k], hints.b);
      if (k > 0) b = std::max(b, cone_b(inner, v, inner_[k - 1], hints.b));
    }
    if (options_.use_c) c = radius_c(outer, v, hints.c);
    const glm::vec3 normal(outer.normal), inner_normal(inner.normal);
    layer.bounds[texel] = {outer.distance, std::clamp(a, 0.0, 1.0), std::clamp(b, 0.0, 1.0), c};
    const bool single = radial_.layers.size() == 1;
    layer.planes[texel] = glm::vec4(normal, single ? again_about(texel) : static_cast<float>(inner.distance));
    if (k > 0) {
      const double r = options_.use_c ? radius_c(inner, v, hints.c) : 0;
      layer.inners[texel] = glm::vec4(inner_normal, static_cast<float>(r));
    }
  }

  // 1 where the inside begins again behind the layer, in this direction or a neighbour's, which catches what is
  // narrower than a texel; else 0.
  float again_about(std::size_t texel) const {
    const CubeTexel at = grid_.texel(texel);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const CubeTexel near{at.face, at.x + dx, at.y + dy};
        if (radial_.again[grid_.index(grid_.nearest(grid_.direction(near)))] != 0) return 1;
      }
    }
    return 0;
  }

  // The narrower of the two cones from the ends of the interval to its middle.
  double cones_between(double from, double to, const glm::dvec3& v, std::size_t& hint) const {
    const double half = 0.5 * (to - from);
    const double outwards = cone_a_cosine({from * v, v, half}, all_, hint);
    return std::max(outwards, cone_a_cosine({to * v, -v, half}, all_, hint));
  }

  double cone_b(const Crossing& crossing, const glm::dvec3& v, const SheetTree& tree, std::size_t& hint) const {
    const ConeB cone{v, crossing.normal, crossing.distance * glm::dot(v, crossing.normal),
                     0.5 * options_.epsilon * solid_.diagonal()};
    if (options_.cone_b == ConeBase::enclosing) return cone_b_enclosing(cone, tree.sheet, grid_);
    return cone_b_inscribed(cone, tree, directions_, hint);
  }

  double radius_c(const Crossing& crossing, const glm::dvec3& v, std::uint32_t& hint) const {
    const Cone cone{center_ + crossing.distance * v, -crossing.normal, cosine_c_, sine_c_};
    const Nearest nearest = solid_.tree().nearest_in_cone(cone, crossing.triangle, hint);
    hint = nearest.triangle;
    return std::min(nearest.distance, solid_.diagonal());
  }

  const Solid& solid_;
  glm::dvec3 center_;
  const CubeOptions& options_;
  const Radial& radial_;
  const SheetTree& directions_;
  CubeGrid grid_;
  std::vector<SheetTree> outer_, inner_;  // by layer; by layer but the first
  std::vector<const SheetTree*> all_, nearest_only_;
  double cosine_c_ = 1, sine_c_ = 0;
};

}  // namespace

std::vector<std::uint8_t> nearest_seeing(const Solid& solid, std::span<const glm::dvec3> centers) {
  std::vector<std::uint8_t> result(solid.triangle_count(), kUnseen);
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(result.size()), 256),
                    [&](const auto& range) {
                      for (std::uint32_t t = range.begin(); t != range.end(); ++t) {
                        const glm::dvec3 at = solid.centroid(t);
                        double least = std::numeric_limits<double>::infinity();
                        for (std::size_t i = 0; i < centers.size(); ++i) {
                          const double distance = glm::distance(at, centers[i]);
                          if (distance >= least || !solid.sees(centers[i], t)) continue;
                          least = distance;
                          result[t] = static_cast<std::uint8_t>(i);
                        }
                      }
                    });
  return result;
}

std::size_t texture_bytes(const CubeOptions& options, std::size_t cubes) {
  const auto layers = static_cast<std::size_t>(options.layers);
  const std::size_t maps = layers * (layers > 1 ? 3 : 2);
  return cubes * maps * CubeGrid(options.resolution).texels() * sizeof(glm::vec4);
}

CubeSet build_cubes(const Solid& solid, std::span<const glm::dvec3> centers, const CubeOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  check(options);
  check(solid, centers);
  CubeSet result;
  result.options = options;
  result.diagonal = solid.diagonal();
  const CubeGrid grid(options.resolution);
  const SheetTree directions(grid, unit_sphere(grid));
  for (const glm::dvec3& center : centers) {
    Cube cube;
    cube.center = center;
    if (options.use_d) cube.sphere = static_cast<float>(solid.tree().nearest(center).distance);
    const Radial radial = trace_all(solid, center, grid, options.layers);
    cube.dropped_share = static_cast<double>(radial.dropped) / static_cast<double>(grid.texels());
    ConeSearches(solid, center, options, radial, directions)
        .fill(cube, fmt::format("cones of cube {} of {}", result.cubes.size() + 1, centers.size()));
    result.cubes.push_back(std::move(cube));
  }

  // A triangle that no centre sees starts in the nearest cube and is left to the search.
  const std::vector<std::uint8_t> seeing = nearest_seeing(solid, centers);
  double unseen = 0;
  std::size_t sources = 0;
  for (std::uint32_t t = 0; t < solid.triangle_count(); ++t)
    sources = std::max(sources, static_cast<std::size_t>(solid.source(t).value_or(0)) + 1);
  result.first_cube.assign(sources, 0);
  for (std::uint32_t t = 0; t < solid.triangle_count(); ++t) {
    std::uint8_t chosen = seeing[t];
    if (chosen == kUnseen) {
      unseen += solid.area(t);
      const glm::dvec3 at = solid.centroid(t);
      chosen = static_cast<std::uint8_t>(std::min_element(centers.begin(), centers.end(),
                                                          [&](const glm::dvec3& a, const glm::dvec3& b) {
                                                            return glm::distance(a, at) < glm::distance(b, at);
                                                          }) -
                                         centers.begin());
    }
    if (const auto source = solid.source(t)) result.first_cube[*source] = chosen;
  }
  result.unseen_share = unseen / solid.area();
  result.build_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace pellucid::geocube
