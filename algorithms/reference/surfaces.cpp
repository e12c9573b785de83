#include <algorithm>
#include <atomic>
#include <cassert>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <tbb/blocked_range2d.h>
#include <tbb/combinable.h>
#include <tbb/parallel_for.h>

#include "algorithms/reference/geometry.hpp"
#include "algorithms/reference/partial_picture.hpp"
#include "algorithms/reference/photons/photon_map.hpp"
#include "algorithms/reference/photons/photon_source.hpp"
#include "algorithms/reference/photons/photons.hpp"
#include "algorithms/reference/pixel_samples.hpp"
#include "algorithms/reference/ray_tree.hpp"
#include "algorithms/reference/reference.hpp"
#include "algorithms/reference/relief/relief_surfaces.hpp"
#include "algorithms/reference/shading.hpp"
#include "algorithms/reference/surface_point.hpp"
#include "algorithms/reference/translucent_path.hpp"
#include "gl/error.hpp"

namespace pellucid {
namespace {

// Lights a point with exact shadows; `rays` counts them. `geometry` null: no light casts one.
glm::dvec3 shade(const Illumination& light, const Geometry* geometry, const SurfacePoint& point, std::uint64_t& rays) {
  // Embree's ray starts at the position rounded to single precision, and a raster position errs by as much again, so
  // it sets out this far above the surface: some hundred roundings of the coordinates that went into it.
  const glm::dvec3 size = glm::abs(point.position);
  const double clearance = 1e-5 * (point.distance + std::max({size.x, size.y, size.z}));
  const glm::dvec3 start = point.position + clearance * point.normal;
  return light.surface_radiance(point.position, point.normal, point.albedo, point.emission,
                                [&](std::size_t index, const Incidence& in) {
                                  if (geometry == nullptr || !light.casts_shadow(index)) return true;
                                  ++rays;
                                  return !geometry->occluded(start, in.to_light, 0.0, in.distance * (1.0 - 1e-6));
                                });
}

void write(float* pixel, const glm::dvec3& radiance) {
  for (int c = 0; c < 3; ++c)
    pixel[c] = static_cast<float>(radiance[c]);
}

glm::dvec3 read(const float* pixel) {
  return {static_cast<double>(pixel[0]), static_cast<double>(pixel[1]), static_cast<double>(pixel[2])};
}

std::size_t pixel_index(const Camera& camera, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(x);
}

// Calls visit(x, y) for all pixels, in parallel. The tiles are small, since few of them may hold all the glass.
template <class F>
void for_pixels(const Camera& camera, const std::function<void(double)>& progress, F visit) {
  const double pixels = static_cast<double>(camera.width) * camera.height;
  std::atomic<std::int64_t> done{0};
  tbb::parallel_for(tbb::blocked_range2d<int>(0, camera.height, 8, 0, camera.width, 16), [&](const auto& tile) {
    for (int y = tile.rows().begin(); y < tile.rows().end(); ++y) {
      for (int x = tile.cols().begin(); x < tile.cols().end(); ++x)
        visit(x, y);
    }
    const auto in_tile = static_cast<std::int64_t>(tile.rows().size() * tile.cols().size());
    if (progress) progress(static_cast<double>(done += in_tile) / pixels);
  });
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// The sums of one thread.
struct Sums {
  TreeTally tally;
  RayTree::Scratch scratch;
};

// Sets the walks' chance apart from the places in the pixels.
constexpr std::uint32_t kPathSeed = 0x5bd1e995U;

// Samples a pixel between two looks at the clock, of pictures that are kept while they grow.
constexpr std::int64_t kSamplesAtOnce = 16;

// The share of the largest optical object's radius over which photons are spread without another radius given.
constexpr double kCausticRadius = 0.01;

// Photons for the light that surfaces get through objects; none when nothing sends or bends light.
std::optional<PhotonMap> trace_caustics(const Scene& scene, const SurfaceOptions& options, double& photons_s) {
  if (!options.caustics) return std::nullopt;
  const auto start = std::chrono::steady_clock::now();
  double radius_m = options.caustic_radius_m;
  if (radius_m <= 0.0) {
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
      if (!optical(scene, scene.instances[i])) continue;
      radius_m = std::max(radius_m, kCausticRadius * bounding_sphere(scene, static_cast<int>(i)).radius);
    }
  }
  PhotonOptions photons;
  photons.photons = options.photons;
  photons.seed = options.seed;
  photons.reflections = options.reflections;
  photons.depth = options.depth;
  Photons landed = trace_photons(scene, {}, photons, true);
  std::optional<PhotonMap> map;
  if (!landed.deposits.empty()) map.emplace(std::move(landed.deposits), radius_m);
  photons_s = seconds_since(start);
  return map;
}

void check_traceable(const Scene& scene, const SurfaceOptions& options) {
  if (!scene.reliefs.empty() && has_scattering(scene)) {
    throw InputError(fmt::format(
        "scene '{}' has reliefs and a solid that scatters: the reference does not trace them together", scene.name));
  }
  if (!scene.volume) return;
  if (has_interfaces(scene)) {
    throw InputError(
        fmt::format("scene '{}' has a volume, and mirrors, metals or dielectrics: the reference does not trace a "
                    "medium behind them",
                    scene.name));
  }
  if (options.samples > 1) {
    throw InputError(fmt::format("{} samples a pixel: the medium of scene '{}' is integrated through its centre alone",
                                 options.samples, scene.name));
  }
}

// Rays from the eye, between the clipping planes.
class EyeRays {
 public:
  EyeRays(const Scene& scene, const Camera& camera, const Geometry& geometry, const RayTree& tree)
      : camera_(camera), geometry_(geometry), tree_(tree) {
    eye_.origin = glm::dvec3(camera.view.eye);
    eye_.inside = tree.solids_at(eye_.origin);
    forward_ = glm::normalize(glm::dvec3(camera.view.target) - eye_.origin);
    solid_ = std::any_of(scene.materials.begin(), scene.materials.end(),
                         [](const Material& m) { return m.kind == SurfaceKind::dielectric; });
  }

  /// Through a place of the picture, in pixels from its upper left corner.
  TreeRay through(double x, double y) const {
    TreeRay ray = eye_;
    ray.direction = camera_.ray_direction(x, y);
    // The clipping planes are at constant view depth.
    const double per_depth = 1.0 / glm::dot(ray.direction, forward_);
    ray.begin = static_cast<double>(camera_.view.near_m) * per_depth;
    ray.end = static_cast<double>(camera_.view.far_m) * per_depth;
    // The part that the near plane cuts off is not there, and the ray may begin inside of what it cuts open.
    if (solid_ && geometry_.occluded(ray.origin, ray.direction, 0.0, ray.begin)) {
      ray.inside = tree_.solids_at(ray.origin + ray.begin * ray.direction);
      ray.unabsorbed_m = ray.begin;
    }
    return ray;
  }

 private:
  const Camera& camera_;
  const Geometry& geometry_;
  const RayTree& tree_;
  TreeRay eye_;
  glm::dvec3 forward_{0.0};
  bool solid_ = false;  // something to begin inside of
};

TreeLimits tree_limits(const SurfaceOptions& options) {
  TreeLimits limits;
  limits.reflections = options.reflections;
  limits.depth = options.depth;
  limits.cut = options.cut;
  limits.entry_reflection = options.entry_reflection;
  limits.both_sides = options.both_sides;
  return limits;
}

// One picture by rays, from the scene's geometry to the layer.
class SurfaceTracing {
 public:
  SurfaceTracing(const Scene& scene, const Camera& camera, const SurfaceOptions& options)
      : scene_(scene),
        camera_(camera),
        options_(options),
        start_(std::chrono::steady_clock::now()),
        geometry_(scene),
        light_(scene),
        tree_(scene, geometry_),
        walks_(scene, geometry_),
        reliefs_(scene, geometry_, light_, {options.refract_light}),
        eye_(scene, camera, geometry_, tree_),
        limits_(tree_limits(options)),
        places_(options.samples, options.seed),
        translucent_(has_scattering(scene)),
        walking_(translucent_ || std::any_of(scene.reliefs.begin(), scene.reliefs.end(),
                                             [](const Relief& relief) { return relief.scatters(); })),
        build_s_(seconds_since(start_)),
        caustics_(trace_caustics(scene, options, photons_s_)),
        picture_(scene, camera, options, walking_),
        kept_samples_(picture_.samples) {
    layer_.radiance = Image(camera.width, camera.height, 3);
    layer_.optical = Image(camera.width, camera.height, 1);
    layer_.distance_m.resize(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  }

  SurfaceLayer run() {
    while (picture_.samples < options_.samples)
      add_samples();
    if (options_.samples > 1) find_distances();
    summarise();
    return std::move(layer_);
  }

 private:
  // The next samples of every pixel: all of them, or so many that a picture which is kept while it grows is looked at.
  void add_samples() {
    const std::int64_t begin = picture_.samples;
    const std::int64_t end =
        walking_ ? std::min<std::int64_t>(options_.samples, begin + kSamplesAtOnce) : std::int64_t{options_.samples};
    const auto progress = [&](double share) {
      options_.progress((static_cast<double>(begin) + share * static_cast<double>(end - begin)) / options_.samples);
    };
    tbb::combinable<Sums> sums;
    for_pixels(camera_, options_.progress ? std::function<void(double)>(progress) : std::function<void(double)>(),
               [&](int x, int y) { sample_pixel(x, y, begin, end, sums.local()); });
    sums.combine_each([&](const Sums& sum) { picture_.tally.add(sum.tally); });
    picture_.samples = end;
    picture_.advance(end == options_.samples);
  }

  void sample_pixel(int x, int y, std::int64_t begin, std::int64_t end, Sums& sum) {
    PixelSum& pixel = picture_.pixels[pixel_index(camera_, x, y)];
    TreeTally tally;
    for (auto s = static_cast<int>(begin); s < static_cast<int>(end); ++s) {
      glm::dvec3 radiance(0.0);
      const Hit first = follow(x, y, s, sum.scratch, tally, pixel, radiance);
      pixel.radiance.add(radiance);
      layer_.distance_m[pixel_index(camera_, x, y)] = first.distance;
      if (first.instance != nullptr && optical(scene_, *first.instance)) ++pixel.met_optical;
    }
    pixel.cut_weight += tally.cut_weight;
    sum.tally.add(tally);
  }

  // One ray's light; returns what it meets first.
  Hit follow(int x, int y, int sample, RayTree::Scratch& scratch, TreeTally& tally, PixelSum& pixel,
             glm::dvec3& radiance) const {
    const auto lit = [&](const Hit&, const SurfacePoint& point, const glm::dvec3&, const glm::dvec3& weight) {
      radiance += weight * shade(light_, &geometry_, point, tally.rays);
      if (caustics_) add_caustics(point, weight, pixel, radiance);
    };
    const auto unlit = [&](const glm::dvec3& direction, const glm::dvec3& weight) {
      radiance += weight * glm::dvec3(scene_.environment.radiance(glm::vec3(direction)));
    };
    Random random(hash_bits(x, y, sample, options_.seed ^ kPathSeed));
    const auto seen_relief = [&](const Hit& hit, const SurfacePoint& point, const glm::dvec3& direction,
                                 const glm::dvec3& weight) {
      const auto seen = reliefs_.seen(hit, point, direction, random, tally.rays);
      if (seen) radiance += weight * seen->radiance;
      return seen.has_value();
    };
    const glm::dvec2 place = places_.at(x, y, sample);
    const TreeRay ray = eye_.through(x + place.x, y + place.y);
    if (!translucent_) return tree_.trace(ray, limits_, scratch, tally, lit, unlit, seen_relief);
    return walks_.trace(ray, limits_, random, tally, lit, unlit);
  }

  // L = albedo / π · E of the photons about the point.
  void add_caustics(const SurfacePoint& point, const glm::dvec3& weight, PixelSum& pixel, glm::dvec3& radiance) const {
    const PhotonMap::Irradiance irradiance = caustics_->at(point.position, point.face);
    const glm::dvec3 radiance_per_irradiance = weight * point.albedo / std::numbers::pi;
    radiance += radiance_per_irradiance * irradiance.mean;
    // Samples of a pixel share the photons, so their errors add up as they are.
    const double share = 1.0 / options_.samples;
    pixel.caustic_error += share * radiance_per_irradiance * glm::sqrt(irradiance.variance);
  }

  // With several samples a pixel's distance is that of its centre.
  void find_distances() {
    for_pixels(camera_, {}, [&](int x, int y) {
      const TreeRay centre = eye_.through(x + 0.5, y + 0.5);
      layer_.distance_m[pixel_index(camera_, x, y)] =
          geometry_.intersect(centre.origin, centre.direction, centre.begin, centre.end).distance;
    });
  }

  void summarise() {
    SurfaceStatistics& statistics = layer_.statistics;
    statistics.samples = options_.samples;
    statistics.kept_samples = kept_samples_;
    statistics.build_s = build_s_;
    statistics.photons_s = photons_s_;
    statistics.trace_s = picture_.trace_s;
    const double pixels = static_cast<double>(layer_.distance_m.size());
    for (int y = 0; y < camera_.height; ++y) {
      for (int x = 0; x < camera_.width; ++x) {
        const PixelSum& pixel = picture_.pixels[pixel_index(camera_, x, y)];
        write(layer_.radiance.at(x, y), pixel.radiance.value());
        *layer_.optical.at(x, y) = static_cast<float>(pixel.met_optical) / static_cast<float>(options_.samples);
        const double error = pixel.radiance.standard_error(), caustic = worst(pixel.caustic_error);
        statistics.cut_weight_max = std::max(statistics.cut_weight_max, pixel.cut_weight / options_.samples);
        statistics.standard_error_max = std::max(statistics.standard_error_max, error);
        statistics.standard_error_mean += error / pixels;
        statistics.caustic_standard_error_max = std::max(statistics.caustic_standard_error_max, caustic);
        statistics.caustic_standard_error_mean += caustic / pixels;
      }
    }
    const TreeTally& all = picture_.tally;
    const double rays_from_eye = pixels * options_.samples;
    statistics.cut_weight_mean = all.cut_weight / rays_from_eye;
    statistics.limited_weight_mean = all.limited_weight / rays_from_eye;
    statistics.lost_weight_mean = all.lost_weight / rays_from_eye;
    statistics.rays = all.rays + (options_.samples > 1 ? layer_.distance_m.size() : 0);
  }

  const Scene& scene_;
  const Camera& camera_;
  const SurfaceOptions& options_;
  const std::chrono::steady_clock::time_point start_;
  const Geometry geometry_;
  const Illumination light_;
  const RayTree tree_;
  const TranslucentPath walks_;
  const ReliefSurfaces reliefs_;
  const EyeRays eye_;
  const TreeLimits limits_;
  const PixelSamples places_;
  const bool translucent_;
  const bool walking_;  // solids or reliefs scatter
  const double build_s_;
  double photons_s_ = 0;
  const std::optional<PhotonMap> caustics_;
  PartialPicture picture_;  // it keeps the time from here on
  const std::int64_t kept_samples_;
  SurfaceLayer layer_;
};

}  // namespace

bool has_interfaces(const Scene& scene) {
  return std::any_of(scene.instances.begin(), scene.instances.end(),
                     [&](const Instance& instance) { return optical(scene, instance); });
}

SurfaceLayer trace_surfaces(const Scene& scene, const Camera& camera, const SurfaceOptions& options) {
  assert(camera.width > 0 && camera.height > 0 && options.samples > 0);
  assert(options.reflections >= 0 && options.depth >= 0 && options.cut >= 0.0);
  check_traceable(scene, options);
  return SurfaceTracing(scene, camera, options).run();
}

SurfaceLayer shade_surfaces(const Scene& scene, const Camera& camera, const SurfacePoints& points) {
  assert(points.distance_m.size() == static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  for ([[maybe_unused]] const Image* image : {&points.albedo, &points.normal, &points.emission})
    assert(image->width == camera.width && image->height == camera.height && image->channels >= 3);
  if (has_interfaces(scene)) {
    throw InputError(fmt::format(
        "the raster pass does not draw the mirrors, metals or dielectrics of scene '{}': take the reference's surfaces "
        "from rays",
        scene.name));
  }

  const Illumination light(scene);
  std::optional<Geometry> geometry;
  for (const Light& emitter : scene.lights) {
    if (emitter.casts_shadow && !geometry) geometry.emplace(scene);
  }
  SurfaceLayer layer;
  layer.radiance = Image(camera.width, camera.height, 3);
  layer.distance_m = points.distance_m;
  const glm::dvec3 origin(camera.view.eye);
  for_pixels(camera, {}, [&](int x, int y) {
    const glm::dvec3 direction = camera.ray_direction(x + 0.5, y + 0.5);
    SurfacePoint point;
    point.distance = points.distance_m[pixel_index(camera, x, y)];
    if (std::isinf(point.distance)) {
      write(layer.radiance.at(x, y), glm::dvec3(scene.environment.radiance(glm::vec3(direction))));
      return;
    }
    point.position = origin + point.distance * direction;
    point.normal = read(points.normal.at(x, y));
    point.albedo = read(points.albedo.at(x, y));
    point.emission = read(points.emission.at(x, y));
    std::uint64_t rays = 0;
    write(layer.radiance.at(x, y), shade(light, geometry ? &*geometry : nullptr, point, rays));
  });
  return layer;
}

}  // namespace pellucid
