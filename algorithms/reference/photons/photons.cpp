#include "algorithms/reference/photons/photons.hpp"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "algorithms/reference/geometry.hpp"
#include "algorithms/reference/photons/photon_source.hpp"
#include "algorithms/reference/ray_tree.hpp"
#include "algorithms/scene/noise.hpp"
#include "algorithms/scene/shapes/bounds.hpp"
#include "gl/error.hpp"

namespace pellucid {
namespace {

constexpr int kMostTexels = 4096;  // along a side
constexpr std::uint64_t kChunk = 4096;
constexpr std::size_t kMostDepositBytes = std::size_t{4} << 30;
// How far from a rectangle's plane, as a share of its size, a surface still belongs to it.
constexpr double kPlane = 1e-4;

// Mean and spread over batches (Welford).
class OverBatches {
 public:
  void add(const glm::dvec3& value, int batch) {
    const glm::dvec3 off = value - mean_;
    mean_ += off / static_cast<double>(batch + 1);
    squares_ += off * (value - mean_);
  }
  Power power(int batches) const {
    return {mean_, glm::sqrt(squares_ / (static_cast<double>(batches) * (batches - 1)))};
  }

 private:
  glm::dvec3 mean_{0.0}, squares_{0.0};
};

// A rectangle, ready for points.
class Grid {
 public:
  explicit Grid(const Receiver& receiver) : receiver_(receiver) {
    const glm::dvec3 normal = glm::cross(receiver.edge_u, receiver.edge_v);
    area_ = glm::length(normal);
    const double longest = std::max(glm::length(receiver.edge_u), glm::length(receiver.edge_v));
    if (!(area_ > 1e-12 * longest * longest))
      throw InputError(fmt::format("receiver '{}': its edges span no area", receiver.name));
    for (const int texels : {receiver.width, receiver.height}) {
      if (texels < 1 || texels > kMostTexels) {
        throw InputError(
            fmt::format("receiver '{}': {} texels is out of range [1, {}]", receiver.name, texels, kMostTexels));
      }
    }
    normal_ = normal / area_;
    tolerance_m_ = kPlane * longest;
    // Rows of the inverse of (edge_u, edge_v, normal).
    to_u_ = glm::cross(receiver.edge_v, normal_) / area_;
    to_v_ = glm::cross(normal_, receiver.edge_u) / area_;
  }

  double texel_area_m2() const { return area_ / (receiver_.width * receiver_.height); }

  /// The texel that a point of an instance falls into, or −1.
  std::ptrdiff_t texel(int instance, const glm::dvec3& point) const {
    if (receiver_.instance >= 0 && receiver_.instance != instance) return -1;
    const glm::dvec3 offset = point - receiver_.origin;
    if (std::abs(glm::dot(offset, normal_)) > tolerance_m_) return -1;
    const double u = glm::dot(offset, to_u_), v = glm::dot(offset, to_v_);
    if (u < 0.0 || u >= 1.0 || v < 0.0 || v >= 1.0) return -1;
    const auto column =
        std::min(static_cast<std::ptrdiff_t>(u * receiver_.width), static_cast<std::ptrdiff_t>(receiver_.width - 1));
    const auto row =
        std::min(static_cast<std::ptrdiff_t>(v * receiver_.height), static_cast<std::ptrdiff_t>(receiver_.height - 1));
    return row * receiver_.width + column;
  }

 private:
  Receiver receiver_;
  glm::dvec3 normal_{0.0}, to_u_{0.0}, to_v_{0.0};
  double area_ = 0.0, tolerance_m_ = 0.0;
};

struct Source {
  PhotonSource light;
  int object;
  Solids inside;  // those that the lamp stands in
};

// The contributions of some thousand photons of one batch and source, added up in the order of their numbers.
struct Chunk {
  struct OnTexel {
    std::size_t map;
    std::size_t texel;
    glm::dvec3 power;
  };
  std::vector<OnTexel> texels;
  std::vector<std::pair<int, glm::dvec3>> landings;  // instance, power
  std::vector<Deposit> deposits;
  glm::dvec3 sent{0.0}, landed{0.0}, escaped{0.0};
  double sent_worst = 0.0, limited = 0.0, lost = 0.0;
  std::uint64_t rays = 0;
};

class Tracing {
 public:
  Tracing(const Scene& scene, const std::vector<Receiver>& receivers, const PhotonOptions& options, bool keep_deposits)
      : scene_(scene), options_(options), keep_deposits_(keep_deposits), geometry_(scene), tree_(scene, geometry_) {
    for (const Receiver& receiver : receivers) {
      grids_.emplace_back(receiver);
      const std::size_t texels = static_cast<std::size_t>(receiver.width) * static_cast<std::size_t>(receiver.height);
      result_.maps.push_back({receiver, grids_.back().texel_area_m2(), std::vector<glm::dvec3>(texels),
                              std::vector<glm::dvec3>(texels), Power{}});
    }
    find_sources();
    per_batch_ = (options.photons + static_cast<std::uint64_t>(options.batches) - 1) /
                 static_cast<std::uint64_t>(options.batches);
    const auto all = static_cast<double>(per_batch_) * options.batches * static_cast<double>(sources_.size());
    if (keep_deposits && all * sizeof(Deposit) > static_cast<double>(kMostDepositBytes)) {
      throw InputError(fmt::format("{} photons for each of {} lights and objects take more than {} GiB to keep",
                                   options.photons, sources_.size(), kMostDepositBytes >> 30));
    }
  }

  Photons run() {
    const auto start = std::chrono::steady_clock::now();
    std::vector<OverBatches> on_instance(scene_.instances.size());
    std::vector<std::vector<OverBatches>> texels;
    std::vector<OverBatches> totals(result_.maps.size());
    for (const LightMap& map : result_.maps)
      texels.emplace_back(map.power_w.size());
    OverBatches sent, landed, escaped;
    double sent_worst = 0.0, limited = 0.0, lost = 0.0;
    for (int batch = 0; batch < options_.batches; ++batch) {
      const std::vector<Chunk> chunks = trace_batch(batch);
      Chunk sum;
      std::vector<glm::dvec3> instances(scene_.instances.size(), glm::dvec3(0.0));
      std::vector<glm::dvec3> map_sums(result_.maps.size(), glm::dvec3(0.0));
      std::vector<std::vector<glm::dvec3>> map_texels;
      for (const LightMap& map : result_.maps)
        map_texels.emplace_back(map.power_w.size(), glm::dvec3(0.0));
      for (const Chunk& chunk : chunks) {
        sum.sent += chunk.sent;
        sum.landed += chunk.landed;
        sum.escaped += chunk.escaped;
        sent_worst += chunk.sent_worst;
        limited += chunk.limited;
        lost += chunk.lost;
        result_.rays += chunk.rays;
        for (const auto& [instance, power] : chunk.landings)
          instances[static_cast<std::size_t>(instance)] += power;
        for (const Chunk::OnTexel& at : chunk.texels) {
          map_texels[at.map][at.texel] += at.power;
          map_sums[at.map] += at.power;
        }
        result_.deposits.insert(result_.deposits.end(), chunk.deposits.begin(), chunk.deposits.end());
      }
      sent.add(sum.sent, batch);
      landed.add(sum.landed, batch);
      escaped.add(sum.escaped, batch);
      for (std::size_t i = 0; i < instances.size(); ++i)
        on_instance[i].add(instances[i], batch);
      for (std::size_t m = 0; m < map_sums.size(); ++m) {
        totals[m].add(map_sums[m], batch);
        for (std::size_t t = 0; t < map_texels[m].size(); ++t)
          texels[m][t].add(map_texels[m][t], batch);
      }
    }

    const int batches = options_.batches;
    result_.sent = sent.power(batches);
    result_.landed = landed.power(batches);
    result_.escaped = escaped.power(batches);
    result_.limited_share = sent_worst > 0.0 ? limited / sent_worst : 0.0;
    result_.lost_share = sent_worst > 0.0 ? lost / sent_worst : 0.0;
    for (const OverBatches& instance : on_instance)
      result_.on_instance.push_back(instance.power(batches));
    for (std::size_t m = 0; m < totals.size(); ++m) {
      result_.maps[m].total = totals[m].power(batches);
      for (std::size_t t = 0; t < texels[m].size(); ++t) {
        const Power power = texels[m][t].power(batches);
        result_.maps[m].power_w[t] = power.mean;
        result_.maps[m].standard_error_w[t] = power.standard_error;
      }
    }
    result_.photons = per_batch_ * static_cast<std::uint64_t>(batches) * sources_.size();
    result_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return std::move(result_);
  }

 private:
  void find_sources() {
    const Bounds world = world_bounds(scene_);
    const Illumination light(scene_);
    for (const Illumination::Emitter& emitter : light.lights()) {
      if (!emitter.casts_shadow) continue;
      const Solids inside = emitter.kind == LightKind::directional ? Solids{} : tree_.solids_at(emitter.position);
      for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
        if (!optical(scene_, scene_.instances[i])) continue;
        const Sphere sphere = bounding_sphere(scene_, static_cast<int>(i));
        if (sphere.radius <= 0.0) continue;
        const double scene_size = glm::distance(glm::dvec3(world.min), glm::dvec3(world.max)) + 2.0 * sphere.radius;
        sources_.push_back({PhotonSource(emitter, sphere, scene_size), static_cast<int>(i), inside});
      }
    }
  }

  std::vector<Chunk> trace_batch(int batch) {
    const std::uint64_t per_source = (per_batch_ + kChunk - 1) / kChunk;
    std::vector<Chunk> chunks(sources_.size() * per_source);
    tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t c) {
      const std::size_t source = c / per_source;
      const std::uint64_t first = (c % per_source) * kChunk;
      trace_chunk(batch, source, first, std::min(first + kChunk, per_batch_), chunks[c]);
      if (options_.progress) {
        const double all = static_cast<double>(chunks.size()) * options_.batches;
        options_.progress(static_cast<double>(++chunks_done_) / all);
      }
    });
    return chunks;
  }

  void trace_chunk(int batch, std::size_t number, std::uint64_t first, std::uint64_t last, Chunk& chunk) const {
    const Source& source = sources_[number];
    const std::uint32_t key = hash_bits(batch, static_cast<std::int32_t>(number), 0, options_.seed);
    const glm::dvec2 shift(unit_float(hash_bits(key ^ 1U)), unit_float(hash_bits(key ^ 2U)));
    // Additive recurrence in two dimensions: α = 1/ρ, 1/ρ² with ρ³ = ρ + 1, moved by a random shift of each batch.
    constexpr double kRho = 1.32471795724474602596;
    const double share = 1.0 / static_cast<double>(per_batch_);
    const double kept_share = share / options_.batches;
    RayTree::Scratch scratch;
    TreeLimits limits;
    limits.reflections = options_.reflections;
    limits.depth = options_.depth;
    limits.cut = options_.roulette;
    TreeRay ray;
    ray.inside = source.inside;
    ray.only_first = source.object;
    for (std::uint64_t i = first; i < last; ++i) {
      const double n = static_cast<double>(i);
      const glm::dvec2 place = glm::fract(shift + n * glm::dvec2(1.0 / kRho, 1.0 / (kRho * kRho)));
      const PhotonSource::Photon photon = source.light.at(place);
      if (worst(photon.power) <= 0.0) continue;
      Random random(key, static_cast<std::uint32_t>(i));
      limits.roulette = [&](double weight) {
        const double survives = weight / limits.cut;
        return static_cast<double>(random.next()) < survives ? 1.0 / survives : 0.0;
      };
      ray.origin = photon.origin;
      ray.direction = photon.direction;
      TreeTally tally;
      const Hit met = tree_.trace(
          ray, limits, scratch, tally,
          [&](const Hit& hit, const SurfacePoint& point, const glm::dvec3&, const glm::dvec3& weight) {
            const glm::dvec3 power = share * weight * photon.power;
            chunk.landed += power;
            chunk.landings.emplace_back(hit.index, power);
            for (std::size_t m = 0; m < grids_.size(); ++m) {
              const std::ptrdiff_t texel = grids_[m].texel(hit.index, point.position);
              if (texel >= 0) chunk.texels.push_back({m, static_cast<std::size_t>(texel), power});
            }
            if (keep_deposits_) {
              chunk.deposits.push_back(
                  {glm::vec3(point.position), glm::vec3(point.face), glm::vec3(kept_share * weight * photon.power)});
            }
          },
          [&](const glm::dvec3&, const glm::dvec3& weight) { chunk.escaped += share * weight * photon.power; });
      chunk.rays += tally.rays;
      if (met.index != source.object) continue;
      const double brightest = share * worst(photon.power);
      chunk.sent += share * photon.power;
      chunk.sent_worst += brightest;
      chunk.limited += brightest * (tally.limited_weight + tally.cut_weight);
      chunk.lost += brightest * tally.lost_weight;
    }
  }

  const Scene& scene_;
  const PhotonOptions& options_;
  bool keep_deposits_;
  Geometry geometry_;
  RayTree tree_;
  std::vector<Grid> grids_;
  std::vector<Source> sources_;
  std::uint64_t per_batch_ = 0;
  std::atomic<std::uint64_t> chunks_done_{0};
  Photons result_;
};

}  // namespace

Photons trace_photons(const Scene& scene, const std::vector<Receiver>& receivers, const PhotonOptions& options,
                      bool keep_deposits) {
  assert(options.photons > 0 && options.batches >= 2 && options.reflections >= 0 && options.depth >= 0);
  return Tracing(scene, receivers, options, keep_deposits).run();
}

}  // namespace pellucid
