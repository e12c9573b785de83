#include "sweeps/reference_cache.hpp"

#include <charconv>
#include <cstdio>
#include <span>

#include <fmt/format.h>

#include "algorithms/scene/hash.hpp"
#include "gl/error.hpp"
#include "sweeps/provenance.hpp"

namespace pellucid::sweeps {
namespace {

/// Raise it when the tracer or the medium's model changes, so that files of the old one are not used.
constexpr int kReferenceVersion = 2;
constexpr std::size_t kMemoryBytes = std::size_t{256} << 20;
/// The reference, its mask and what FLIP keeps of it.
constexpr std::size_t kBytesPerPixel = 128;

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

/// What determines the reference's pixels, but for the raster surfaces, which are hashed as they are.
std::string key_of(RenderSession& session, const Point& point) {
  const Camera& camera = session.camera();
  const View& v = camera.view;
  Sha256 hash;
  hash.add(fmt::format("{} {} {}x{}", kReferenceVersion, session.scene().content_hash(), camera.width, camera.height));
  hash.add(fmt::format("{} {} {} {} {} {} {} {} {} {} {} {}", v.eye.x, v.eye.y, v.eye.z, v.target.x, v.target.y,
                       v.target.z, v.up.x, v.up.y, v.up.z, v.fov_y_deg, v.near_m, v.far_m));
  hash.add(fmt::format("{} {} {}", point.reference.raster_surfaces ? "raster" : "rays", point.reference.tolerance,
                       point.reference.max_steps));
  return hash.hex();
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
    const bool intact = in.attributes.at("pellucid.reference_key") == key &&
                        in.attributes.at("pellucid.pixels_sha256") == pixels_hash(*reference);
    if (intact) return reference;
    fmt::print(stderr, "warning: cached reference '{}' is damaged; tracing it again\n", file.string());
  } catch (const std::exception& e) {  // missing attributes and layers too
    fmt::print(stderr, "warning: cached reference '{}' cannot be used ({}); tracing it again\n", file.string(),
               e.what());
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
  write_exr(path(key), out, ExrPixel::single);
}

std::shared_ptr<const CachedReference> ReferenceCache::get(RenderSession& session, const Point& point,
                                                           const Progress& progress) {
  std::string memory_key = key_of(session, point);
  for (const std::string& metric : point.metrics)
    memory_key += " " + metric;
  for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
    if (entry->key != memory_key) continue;
    entries_.splice(entries_.begin(), entries_, entry);
    return entries_.front().reference;
  }

  // The forward pass may change without the scene: its very pixels are part of a file's key.
  const SurfaceLayer surfaces =
      point.reference.raster_surfaces ? session.raster_surfaces() : trace_surfaces(session.scene(), session.camera());
  Sha256 hash;
  hash.add(key_of(session, point));
  hash.add(bytes_of(surfaces.radiance.pixels));
  hash.add(std::as_bytes(std::span(surfaces.distance_m)));
  const std::string file_key = hash.hex();

  const ReferenceFiles files(folder_);
  std::unique_ptr<Reference> reference = files.read(file_key);
  if (!reference) {
    ReferenceOptions options;
    options.tolerance = point.reference.tolerance;
    options.max_steps = point.reference.max_steps;
    options.progress = progress;
    reference = std::make_unique<Reference>(render_reference(session.scene(), session.camera(), surfaces, options));
    try {
      files.write(file_key, *reference);
    } catch (const RuntimeError& e) {
      fmt::print(stderr, "warning: the reference is not cached: {}\n", e.what());
    }
  }

  bool any_masked = false;
  for (const float m : reference->mask.pixels)
    any_masked = any_masked || m > 0.5F;
  ComparisonOptions options;
  options.metrics = MetricSet(point.metrics);
  const std::size_t pixels =
      static_cast<std::size_t>(reference->image.width) * static_cast<std::size_t>(reference->image.height);
  auto cached = std::make_shared<CachedReference>(CachedReference{
      Comparison(std::move(reference->image), any_masked ? &reference->mask : nullptr, std::move(options)),
      reference->step_error_max, reference->step_error_mean, reference->unconverged_share});
  entries_.push_front({std::move(memory_key), pixels * kBytesPerPixel, cached});
  std::size_t total = 0;
  for (auto entry = entries_.begin(); entry != entries_.end();) {
    total += entry->bytes;
    entry = total > kMemoryBytes && entry != entries_.begin() ? entries_.erase(entry) : std::next(entry);
  }
  return cached;
}

}  // namespace pellucid::sweeps
