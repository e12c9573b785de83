#include "algorithms/reference/partial_picture.hpp"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include <fmt/format.h>

#include "algorithms/scene/files/hash.hpp"
#include "gl/error.hpp"

namespace pellucid {
namespace {

/// Raise it when what is traced or how it is written changes.
constexpr int kVersion = 1;
constexpr double kWorthKeeping_s = 2;
constexpr double kShareForWriting = 0.02;  // of the time, once a picture is worth keeping

std::string key_of(const std::string& scene_hash, const Camera& camera, const SurfaceOptions& o) {
  const auto words = [](const glm::vec3& v) { return fmt::format("{} {} {} ", v.x, v.y, v.z); };
  const View& view = camera.view;
  Sha256 hash;
  hash.add(fmt::format("{} {} {}{}{}{} {} {} {}x{} ", kVersion, scene_hash, words(view.eye), words(view.target),
                       words(view.up), view.fov_y_deg, view.near_m, view.far_m, camera.width, camera.height));
  hash.add(fmt::format("{} {} {} {} {} {}{}", o.samples, o.seed, o.reflections, o.depth, o.cut, o.entry_reflection,
                       o.both_sides));
  return hash.hex();
}

double seconds_between(std::chrono::steady_clock::time_point a, std::chrono::steady_clock::time_point b) {
  return std::chrono::duration<double>(b - a).count();
}

}  // namespace

PartialPicture::PartialPicture(const Scene& scene, const Camera& camera, const SurfaceOptions& options, bool lasting)
    : pixels(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height)),
      last_(std::chrono::steady_clock::now()),
      written_(last_) {
  const std::string scene_hash = scene.content_hash();
  const std::filesystem::path folder = cache_folder("paths");
  if (!lasting || scene_hash.empty() || options.caustics || folder.empty()) return;
  const std::string key = key_of(scene_hash, camera, options);
  file_ = {folder / (key + ".sums"), "traced paths", key};
  const std::size_t count = pixels.size();
  const bool known = file_.read([&](std::span<const std::byte> bytes) {
    ByteReader in(bytes);
    in.take(samples);
    in.take(trace_s);
    in.take(tally);
    in.take(pixels);
    if (!in.done() || pixels.size() != count || samples < 0 || samples > options.samples)
      throw InputError("it is of another picture");
  });
  if (known) return;
  samples = 0;
  trace_s = 0;
  tally = {};
  pixels.assign(count, {});
}

void PartialPicture::advance(bool done) {
  const auto now = std::chrono::steady_clock::now();
  trace_s += seconds_between(last_, now);
  last_ = now;
  if (file_.path.empty() || trace_s < kWorthKeeping_s) return;
  if (!done && seconds_between(written_, now) < std::max(kWorthKeeping_s, write_s_ / kShareForWriting)) return;
  ByteWriter out;
  out.add(samples);
  out.add(trace_s);
  out.add(tally);
  out.add(pixels);
  file_.keep(out.bytes());
  written_ = last_ = std::chrono::steady_clock::now();
  write_s_ = seconds_between(now, written_);
}

}  // namespace pellucid
