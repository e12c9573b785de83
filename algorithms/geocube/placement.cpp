#include "algorithms/geocube/placement.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "algorithms/geocube/cubes.hpp"
#include "algorithms/scene/noise.hpp"
#include "gl/error.hpp"

namespace pellucid::geocube {
namespace {

using Flags = std::vector<char>;  // by triangle

// A triangle's area counts less the more aslant a centre sees it, since there the cube's texels lie far apart.
// It decides between centres that see the same.
constexpr double kAslant = 0.02;
// A centre beside a wall spends most of its texels on it. It decides likewise, within this distance [diagonals].
constexpr double kBeside = 0.02, kClear = 0.02;

class Chooser {
 public:
  Chooser(const Solid& solid, const PlacementOptions& options)
      : solid_(solid), options_(options), random_(options.seed), order_(solid.triangle_count()) {
    std::iota(order_.begin(), order_.end(), 0U);
    for (std::size_t i = order_.size(); i > 1; --i)
      std::swap(order_[i - 1], order_[static_cast<std::size_t>(random_.below(static_cast<int>(i)))]);
    const auto wanted = static_cast<std::size_t>(options_.candidates);
    add_between_walls(order_, wanted / 2);
    for (std::size_t tries = 0; candidates_.size() < wanted && tries < 100 * wanted; ++tries) {
      const glm::dvec3 at = within_box();
      add_candidate(solid_.low() + at * (solid_.high() - solid_.low()));
    }
  }

  std::vector<glm::dvec3> choose() {
    while (centers_.size() < static_cast<std::size_t>(options_.cubes)) {
      const std::vector<std::uint32_t> open = unseen(centers_.size());
      if (!centers_.empty()) add_between_walls(open, static_cast<std::size_t>(options_.candidates) / 4);
      const std::vector<glm::dvec3> likely = most_promising(open);
      const std::vector<double> gains = gains_of(likely, open, centers_.empty());
      const auto best = std::max_element(gains.begin(), gains.end());
      if (best == gains.end() || *best <= 0) break;
      centers_.push_back(likely[static_cast<std::size_t>(best - gains.begin())]);
      seen_.push_back(seen_from(centers_.back()));
      for (std::size_t i = centers_.size(); i-- > 0;)  // the newest first, then those that it relieves
        improve(i);
      double area = solid_.area();
      for (const std::uint32_t t : unseen(centers_.size(), order_.size()))
        area -= solid_.area(t);
      if (area >= options_.enough * solid_.area()) break;
    }
    return centers_;
  }

 private:
  // In [0, 1] and in [-1, 1] along each axis. As arguments of a call the numbers would be drawn in an order that each
  // compiler chooses, and cubes would stand elsewhere.
  glm::dvec3 within_box() {
    const double z = random_.next(), y = random_.next(), x = random_.next();
    return {x, y, z};
  }
  glm::dvec3 any_step() {
    const double z = random_.range(-1, 1), y = random_.range(-1, 1), x = random_.range(-1, 1);
    return {x, y, z};
  }

  // The candidates that see most of a few of the triangles: those worth asking about all of them. The triangles are in
  // random order, so that the first ones are a fair sample, and one in twenty candidates leaves room for its error.
  std::vector<glm::dvec3> most_promising(const std::vector<std::uint32_t>& open) const {
    constexpr std::size_t kFew = 400, kPart = 20;
    if (open.size() <= kFew || candidates_.size() <= kPart) return candidates_;
    const std::vector<std::uint32_t> few(open.begin(), open.begin() + kFew);
    const std::vector<double> gains = gains_of(candidates_, few, centers_.empty());
    std::vector<std::size_t> order(candidates_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return gains[a] > gains[b]; });
    std::vector<glm::dvec3> out;
    for (std::size_t i = 0; i < std::max<std::size_t>(1, candidates_.size() / kPart); ++i)
      out.push_back(candidates_[order[i]]);
    return out;
  }

  // Midway between opposite walls, as seen from some of the triangles: this finds the middle of ears and limbs.
  void add_between_walls(const std::vector<std::uint32_t>& triangles, std::size_t count) {
    const double nudge = 1e-5 * solid_.diagonal();
    for (std::size_t i = 0; i < count && !triangles.empty(); ++i) {
      const std::uint32_t t = triangles[i * triangles.size() / count];
      const glm::dvec3 normal = solid_.facet_normal(t);
      const glm::dvec3 tilt = any_step();
      const glm::dvec3 inwards = glm::normalize((i % 2 == 0 ? 0.0 : 0.5) * tilt - normal);
      const glm::dvec3 from = solid_.centroid(t) - nudge * normal;
      const auto hit = solid_.first_hit(from, inwards);
      if (hit && hit->leaves) add_candidate(from + (i % 2 == 0 ? 0.5 : 0.8) * hit->distance * inwards);
    }
  }

  bool usable(const glm::dvec3& p) const {
    return solid_.contains(p) && solid_.tree().nearest(p).distance > 1e-4 * solid_.diagonal();
  }
  void add_candidate(const glm::dvec3& p) {
    if (usable(p)) candidates_.push_back(p);
  }

  Flags seen_from(const glm::dvec3& center) const {
    Flags flags(solid_.triangle_count());
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(flags.size()), 512),
                      [&](const auto& range) {
                        for (std::uint32_t t = range.begin(); t != range.end(); ++t)
                          flags[t] = solid_.sees(center, t) ? 1 : 0;
                      });
    return flags;
  }

  // Triangles that none of the centres sees, number `except` left out; the first `most` in random order.
  std::vector<std::uint32_t> unseen(std::size_t except, std::size_t most) const {
    std::vector<std::uint32_t> result;
    for (const std::uint32_t t : order_) {
      bool any = false;
      for (std::size_t i = 0; i < seen_.size() && !any; ++i)
        any = i != except && seen_[i][t] != 0;
      if (any) continue;
      result.push_back(t);
      if (result.size() == most) break;
    }
    return result;
  }
  std::vector<std::uint32_t> unseen(std::size_t except) const {
    return unseen(except, static_cast<std::size_t>(options_.samples));
  }

  // The area that each place sees of the triangles, aslant a little less where it is to see them `alone`. Beside others
  // it would be drawn to the best place for the few triangles that are left to it.
  std::vector<double> gains_of(const std::vector<glm::dvec3>& places, const std::vector<std::uint32_t>& triangles,
                               bool alone) const {
    std::vector<double> gains(places.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, places.size(), 4), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        for (const std::uint32_t t : triangles) {
          if (!solid_.sees(places[i], t)) continue;
          const glm::dvec3 from = glm::normalize(solid_.centroid(t) - places[i]);
          const double aslant = alone ? kAslant * (1 - glm::dot(from, solid_.facet_normal(t))) : 0;
          gains[i] += solid_.area(t) * (1 - aslant);
        }
        const double clear = solid_.tree().nearest(places[i]).distance / (kClear * solid_.diagonal());
        gains[i] *= 1 - kBeside * std::max(0.0, 1 - clear);
      }
    });
    return gains;
  }

  // Moves one centre to better places near it.
  void improve(std::size_t i) {
    constexpr std::size_t kMoves = 16;
    const std::vector<std::uint32_t> open = unseen(i);
    const bool alone = centers_.size() == 1;
    double most = gains_of({centers_[i]}, open, alone).front();
    bool moved = false;
    for (double reach = 0.08 * solid_.diagonal(); reach > 0.004 * solid_.diagonal(); reach *= 0.5) {
      std::vector<glm::dvec3> moves;
      for (std::size_t m = 0; m < kMoves; ++m) {
        const glm::dvec3 step = any_step();
        if (usable(centers_[i] + reach * step)) moves.push_back(centers_[i] + reach * step);
      }
      const std::vector<double> gains = gains_of(moves, open, alone);
      const auto best = std::max_element(gains.begin(), gains.end());
      if (best == gains.end() || *best <= most) continue;
      most = *best;
      centers_[i] = moves[static_cast<std::size_t>(best - gains.begin())];
      moved = true;
    }
    if (moved) seen_[i] = seen_from(centers_[i]);
  }

  const Solid& solid_;
  const PlacementOptions& options_;
  Random random_;
  std::vector<std::uint32_t> order_;  // the triangles, shuffled
  std::vector<glm::dvec3> candidates_, centers_;
  std::vector<Flags> seen_;  // by centre
};

}  // namespace

Placement place_cubes(const Solid& solid, const PlacementOptions& options) {
  if (options.cubes < 1 || options.cubes > static_cast<int>(kMaxCubes))
    throw InputError(fmt::format("geocube: cubes = {} is out of range [1, {}]", options.cubes, kMaxCubes));
  Placement result;
  result.centers = Chooser(solid, options).choose();
  if (result.centers.empty()) throw InputError(fmt::format("geocube: mesh '{}' is too thin for a cube", solid.name()));

  std::vector<std::uint8_t> first(solid.triangle_count());
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(first.size()), 256),
                    [&](const auto& range) {
                      for (std::uint32_t t = range.begin(); t != range.end(); ++t) {
                        first[t] = kUnseen;
                        for (std::size_t i = 0; i < result.centers.size() && first[t] == kUnseen; ++i) {
                          if (solid.sees(result.centers[i], t)) first[t] = static_cast<std::uint8_t>(i);
                        }
                      }
                    });
  result.unseen.assign(result.centers.size(), 1.0);
  for (std::size_t i = 0; i < result.centers.size(); ++i) {
    double area = 0;
    for (std::uint32_t t = 0; t < solid.triangle_count(); ++t)
      area += first[t] > i ? solid.area(t) : 0;
    result.unseen[i] = area / solid.area();
  }
  return result;
}

}  // namespace pellucid::geocube
