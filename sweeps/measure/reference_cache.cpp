#include "sweeps/measure/reference_cache.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <iterator>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/parameter_names.hpp"
#include "algorithms/scene/files/hash.hpp"
#include "algorithms/scene/files/tell.hpp"
#include "gl/error.hpp"
#include "sweeps/measure/reference_methods.hpp"
#include "sweeps/spec/provenance.hpp"

namespace pellucid::sweeps {
namespace {

/// Raise it when the tracer or the medium's model changes, so that files of the old one are not used.
constexpr int kReferenceVersion = 3;
constexpr std::size_t kMemoryBytes = std::size_t{256} << 20;
/// The reference, its mask and what FLIP keeps of it.
constexpr std::size_t kBytesPerPixel = 128;

/// The part of SurfaceStatistics that a file keeps, besides its counts.
constexpr std::pair<const char*, double SurfaceStatistics::*> kSurfaceStatistics[] = {
    {"standard_error_max", &SurfaceStatistics::standard_error_max},
    {"standard_error_mean", &SurfaceStatistics::standard_error_mean},
    {"cut_weight_max", &SurfaceStatistics::cut_weight_max},
    {"cut_weight_mean", &SurfaceStatistics::cut_weight_mean},
    {"limited_weight_mean", &SurfaceStatistics::limited_weight_mean},
    {"lost_weight_mean", &SurfaceStatistics::lost_weight_mean},
    {"caustic_standard_error_max", &SurfaceStatistics::caustic_standard_error_max},
    {"caustic_standard_error_mean", &SurfaceStatistics::caustic_standard_error_mean},
    {"build_s", &SurfaceStatistics::build_s},
    {"photons_s", &SurfaceStatistics::photons_s},
    {"trace_s", &SurfaceStatistics::trace_s}};

std::string number(double value) {
  return fmt::format("{}", value);
}

std::span<const std::byte> bytes_of(const std::vector<float>& values) {
  return std::as_bytes(std::span(values));
}

std::string pixels_hash(const Reference& reference) {
  Sha256 hash;
  hash.add(bytes_of(reference.image.pixels));
  hash.add(bytes_of(reference.mask.pixels));
  return hash.hex();
}

/// The exact reference's pixels depend on this, but for the surfaces, which are hashed as they are.
std::string key_of(RenderSession& session, const Point& point) {
  const Camera& camera = session.camera();
  const View& v = camera.view;
  Sha256 hash;
  hash.add(fmt::format("{} {} {}x{}", kReferenceVersion, session.scene().content_hash(), camera.width, camera.height));
  hash.add(fmt::format("{} {} {} {} {} {} {} {} {} {} {} {}", v.eye.x, v.eye.y, v.eye.z, v.target.x, v.target.y,
                       v.target.z, v.up.x, v.up.y, v.up.z, v.fov_y_deg, v.near_m, v.far_m));
  hash.add(fmt::format("{} {}", point.reference.tolerance, point.reference.max_steps));
  return hash.hex();
}

/// A CachedReference depends on this: the settings, and of the point what a drawn part of it depends on.
std::string memory_key_of(RenderSession& session, const Point& point) {
  std::string key = key_of(session, point) + to_json(point.reference).dump();
  for (const std::string& metric : point.metrics)
    key += " " + metric;
  for (const auto& [name, value] : point.parameters) {
    if (route(name).owner == ParameterOwner::shadow) key += fmt::format(" {}={}", name, to_text(value));
  }
  return key;
}

bool any_marked(const Image& mask) {
  return std::any_of(mask.pixels.begin(), mask.pixels.end(), [](float m) { return m > 0.5F; });
}

double marked_share(const Image& mask) {
  const auto marked = std::count_if(mask.pixels.begin(), mask.pixels.end(), [](float m) { return m > 0.5F; });
  return static_cast<double>(marked) / static_cast<double>(mask.pixels.size());
}

}  // namespace

std::unique_ptr<Reference> ReferenceFiles::read(const std::string& key) const {
  const std::filesystem::path file = path(key);
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return nullptr;
  try {
    ImageFile in = read_image(file);
    auto reference = std::make_unique<Reference>();
    const auto value = [&](const char* name) {
      const std::string& text = in.attributes.at(fmt::format("pellucid.{}", name));
      double result = 0;
      const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), result);
      if (status != std::errc{} || end != text.data() + text.size()) throw InputError("a number that is none");
      return result;
    };
    reference->image = std::move(in.image);
    reference->mask = std::move(in.layers.at("mask"));
    reference->step_error_max = value("step_error_max");
    reference->step_error_mean = value("step_error_mean");
    reference->unconverged_share = value("unconverged_share");
    for (const auto& [name, member] : kSurfaceStatistics)
      reference->surfaces.*member = value(name);
    reference->surfaces.samples = static_cast<int>(value("samples"));
    reference->surfaces.rays = static_cast<std::uint64_t>(value("rays"));
    const bool intact = in.attributes.at("pellucid.reference_key") == key &&
                        in.attributes.at("pellucid.pixels_sha256") == pixels_hash(*reference);
    if (intact) return reference;
    tell("warning: cached reference '{}' is damaged; tracing it again", file.string());
  } catch (const std::exception& e) {  // missing attributes and layers too
    tell("warning: cached reference '{}' cannot be used ({}); tracing it again", file.string(), e.what());
  }
  return nullptr;
}

void ReferenceFiles::write(const std::string& key, const Reference& reference) const {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) throw RuntimeError(fmt::format("folder '{}' cannot be made: {}", folder_.string(), error.message()));
  ImageFile out;
  out.image = reference.image;
  out.layers["mask"] = reference.mask;
  out.attributes = {{"pellucid.reference_key", key},
                    {"pellucid.pixels_sha256", pixels_hash(reference)},
                    {"pellucid.step_error_max", number(reference.step_error_max)},
                    {"pellucid.step_error_mean", number(reference.step_error_mean)},
                    {"pellucid.unconverged_share", number(reference.unconverged_share)},
                    {"pellucid.commit", kCommit}};
  for (const auto& [name, member] : kSurfaceStatistics)
    out.attributes[fmt::format("pellucid.{}", name)] = number(reference.surfaces.*member);
  out.attributes["pellucid.samples"] = number(reference.surfaces.samples);
  out.attributes["pellucid.rays"] = number(static_cast<double>(reference.surfaces.rays));
  write_exr(path(key), out, ExrPixel::single);
}

Reference ReferenceCache::traced(const std::string& key, const std::function<Reference()>& trace) const {
  const ReferenceFiles files(folder_);
  if (std::unique_ptr<Reference> found = files.read(key)) return std::move(*found);
  Reference reference = trace();
  try {
    files.write(key, reference);
  } catch (const RuntimeError& e) {
    tell("warning: the reference is not cached: {}", e.what());
  }
  return reference;
}

std::shared_ptr<const CachedReference> ReferenceCache::get(RenderSession& session, const Point& point,
                                                           const Progress& progress) {
  std::string memory_key = memory_key_of(session, point);
  for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
    if (entry->key != memory_key) continue;
    entries_.splice(entries_.begin(), entries_, entry);
    return entries_.front().reference;
  }

  const ReferenceSettings settings = settled(point.reference, session.scene().name, has_interfaces(session.scene()),
                                             session.scene().volume.has_value());
  // Traced surfaces follow from what the key holds and are not needed if the file is there.
  const bool traced_surfaces = settings.surfaces == ReferenceSurfaces::rays;
  std::optional<SurfaceLayer> made;
  const auto surfaces = [&]() -> const SurfaceLayer& {
    if (!made) made = reference_surfaces(session, settings, progress);
    return *made;
  };
  const Camera& camera = session.camera();
  ReferenceOptions options;
  options.tolerance = settings.tolerance;
  options.max_steps = settings.max_steps;
  options.progress = progress;
  // The forward pass may change without the scene: its very pixels are part of a file's key.
  const auto file_key = [&](std::string_view kind) {
    Sha256 hash;
    hash.add(kind);
    hash.add(key_of(session, point));
    if (traced_surfaces) {
      hash.add(fmt::format("rays {} {} {} {} {}", settings.samples, settings.reflections, settings.cut,
                           settings.caustics, settings.caustics ? settings.photons : 0));
      if (settings.refract_light) hash.add("refract_light");
    } else {
      hash.add(bytes_of(surfaces().radiance.pixels));
      hash.add(std::as_bytes(std::span(surfaces().distance_m)));
    }
    return hash.hex();
  };
  Reference exact =
      traced(file_key("exact"), [&] { return render_reference(session.scene(), camera, surfaces(), options); });

  std::vector<Region> regions;
  if (any_marked(exact.mask)) regions.push_back({"_mask", exact.mask});
  std::optional<double> shadow_pixels_share;
  if (settings.shadow_share > 0) {
    const Reference unshadowed = traced(file_key("unshadowed"), [&] {
      return trace_unshadowed(load_again(point.scene, point.parameters.table()), camera, surfaces(), options);
    });
    Image mask = shadow_mask(exact.image, unshadowed.image, settings.shadow_share);
    shadow_pixels_share = marked_share(mask);
    if (any_marked(mask)) regions.push_back({"_shadow", std::move(mask)});
  }

  std::optional<ComparisonResult> to_exact;
  Image judge = std::move(exact.image);
  if (settings.method == ReferenceMethod::slices) {
    Image slices =
        draw_slices(point.scene, point.parameters.table(), camera.view.name, camera.width, camera.height, settings);
    ComparisonOptions distance;
    distance.metrics = MetricSet(std::vector<std::string>{"flip", "rmse"});
    to_exact = Comparison(std::move(judge), nullptr, std::move(distance)).compare(slices);
    judge = std::move(slices);
  }
  ComparisonOptions comparing;
  comparing.metrics = MetricSet(point.metrics);
  comparing.keep_map = comparing.metrics.has("flip");  // for errors_by_class.hpp
  const std::size_t pixels = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  auto cached = std::make_shared<CachedReference>(CachedReference{
      Comparison(std::move(judge), regions, std::move(comparing)), exact.step_error_max, exact.step_error_mean,
      exact.unconverged_share, traced_surfaces ? std::optional(exact.surfaces) : std::nullopt, shadow_pixels_share,
      std::move(to_exact)});
  entries_.push_front({std::move(memory_key), pixels * kBytesPerPixel, cached});
  std::size_t total = 0;
  for (auto entry = entries_.begin(); entry != entries_.end();) {
    total += entry->bytes;
    entry = total > kMemoryBytes && entry != entries_.begin() ? entries_.erase(entry) : std::next(entry);
  }
  return cached;
}

}  // namespace pellucid::sweeps
