#include "algorithms/local_cube_maps/hit_errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>

#include <nlohmann/json.hpp>

#include "algorithms/raster/native_map.hpp"

namespace pellucid::local_cube_maps {

/// The outputs of report.frag.glsl, four floats a pixel each, rows from the bottom.
struct RayReport {
  std::vector<float> origin, direction, hit;
};

namespace {

constexpr double kOffset = 1e-4;  // of the hit's distance, before a point counts as hidden
constexpr std::array<const char*, 4> kClasses{"right", "other_surface", "hidden", "unconverged"};

// The maps, in their order.
enum : std::size_t { kHit, kDirection, kClass };

double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

void summarise_values(const std::vector<double>& values, const std::string& name, nlohmann::json& out) {
  if (values.empty()) return;
  double sum = 0;
  for (const double v : values)
    sum += v;
  out[name + "_mean"] = sum / static_cast<double>(values.size());
  out[name + "_median"] = quantile(values, 0.5);
  out[name + "_q95"] = quantile(values, 0.95);
}

double share(std::size_t part, std::size_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

double angle_deg(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180.0 / std::numbers::pi;
}

glm::dvec3 xyz(const float* texel) {
  return {static_cast<double>(texel[0]), static_cast<double>(texel[1]), static_cast<double>(texel[2])};
}

}  // namespace

HitClass classify(const HitPlace& place, int cube_size) {
  if (place.hidden) return HitClass::hidden;
  const double texel_deg = std::atan(2.0 / cube_size) * 180.0 / std::numbers::pi;
  if (place.direction_error_deg <= kRightTexels * texel_deg) return HitClass::right;
  const bool converged = std::abs(place.ratio - 1) <= kConverged;
  return converged && place.off_plane > 2 * kConverged ? HitClass::other_surface : HitClass::unconverged;
}

// Where a refracted ray leaves the object, and in which direction, beside the exact way through it.
void HitErrors::add_exit(const InterfaceTracer& tracer, const Camera& camera, std::size_t pixel, int instance,
                         const glm::dvec3& from, const glm::dvec3& R) {
  // GL's rows start at the bottom, the tracer's at the top.
  const auto width = static_cast<std::size_t>(camera.width);
  const int x = static_cast<int>(pixel % width), y = camera.height - 1 - static_cast<int>(pixel / width);
  const InterfaceHit entry = tracer.primary(camera, x, y);
  if (entry.instance != instance || !entry.front) return;
  const InnerPath path = tracer.through(entry, camera.ray_direction(x + 0.5, y + 0.5), 0);
  if (path.vertices.empty() || !path.vertices.front().leaving) return;
  const InnerVertex& exit = path.vertices.front();
  exit_diagonals_.push_back(glm::distance(from, exit.hit.position) / tracer.diagonal_m(instance));
  exit_deg_.push_back(angle_deg(R, *exit.leaving));
}

// One object's pixels. The environment is everything but the object itself, as in its maps.
void HitErrors::add(const DynamicObjects::Object& object, const InterfaceTracer& tracer, const Camera& camera,
                    const RayReport& report) {
  const glm::dvec3 o(object.reference);
  for (std::size_t i = 0; i < report.origin.size(); i += 4) {
    if (report.origin[i + 3] < 0.5F) continue;
    ++pixels_;
    if (report.hit[i + 3] < 0.5F) continue;  // total reflection: this ray leaves nothing
    const glm::dvec3 x = xyz(&report.origin[i]), R = glm::normalize(xyz(&report.direction[i])), l = xyz(&report.hit[i]);
    if (object.refractor != nullptr && refracts_twice_) add_exit(tracer, camera, i / 4, object.instance, x, R);
    const InterfaceHit hit = tracer.nearest_without(x, R, object.instance);
    ++rays_;
    if (!hit) {
      ++escaped_;
      continue;
    }
    const glm::dvec3 q = x + R * hit.distance_m, to_q = q - o;
    const double away = glm::length(to_q);
    HitPlace place;
    place.direction_error_deg = angle_deg(l - o, to_q);
    place.hidden =
        away > 0 && tracer.nearest_without(o, to_q / away, object.instance).distance_m < away * (1 - kOffset) - kOffset;
    const auto put = [&](std::size_t map, double value) { gl_pixel(maps_[map], i / 4) = static_cast<float>(value); };
    put(kDirection, place.direction_error_deg);
    if (place.hidden)
      ++hidden_;
    else
      seen_deg_.push_back(place.direction_error_deg);
    if (lookup_kind_ == RayLookup::direction) continue;
    put(kHit, glm::distance(l, q));
    if (lookup_kind_ != RayLookup::search) continue;
    place.ratio = glm::length(l - o) / static_cast<double>(report.direction[i + 3]);
    if (!(std::abs(place.ratio - 1) <= kConverged)) ++unconverged_;
    place.off_plane = away > 0 ? std::abs(glm::dot(hit.face, l - q)) / away : 0;
    put(kClass, static_cast<double>(classify(place, cube_size_)));
  }
}

HitErrors::HitErrors(DynamicObjects& objects, const Scene& scene, const ForwardPass& forward, const Camera& camera,
                     const MapSettings& maps, const LookupSettings& lookup)
    : lookup_kind_(lookup.kind), refracts_twice_(lookup.bounces > 1), cube_size_(maps.cube_size) {
  const auto add_map = [&](const char* name, const char* unit, const char* doc) -> NativeMap& {
    return maps_.emplace_back(make_native_map(name, unit, doc, camera.width, camera.height));
  };
  add_map("hit_error_m", "m", "distance of the hit from the true one");
  add_map("direction_error_deg", "deg", "angle between the hit and the true one, seen from the reference point");
  add_map("hit_class", "class",
          "0 within two texels of the true hit, 1 on another surface, 2 hidden from the reference point, 3 on none")
      .classes.assign(kClasses.begin(), kClasses.end());

  const auto make = [&](const char* name) {
    return gl::Texture::make_2d(name, gl::Format::rgba32f, camera.width, camera.height);
  };
  const gl::Texture origin = make("ray origins"), direction = make("ray directions"), hit = make("ray hits");
  const gl::Texture depth = gl::Texture::make_2d("ray depth", gl::Format::depth32f, camera.width, camera.height);
  const gl::Framebuffer framebuffer("rays", {&origin, &direction, &hit}, &depth);
  // This draws the surfaces before the objects, without a colour.
  const gl::Program covers("rays' depth",
                           {"algorithms/shaders/opaque.vert.glsl", "algorithms/local_cube_maps/depth.frag.glsl"});
  const InterfaceTracer tracer(scene);
  for (const DynamicObjects::Object& object : objects.objects()) {
    framebuffer.bind();
    for (int i = 0; i < 3; ++i)
      framebuffer.clear_color(i, {0, 0, 0, 0});
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    forward.draw_geometry(camera.projection() * camera.world_to_view(), covers, Objects::all);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    objects.draw_report(scene, forward, camera, maps, lookup, object);
    add(object, tracer, camera, {origin.read(), direction.read(), hit.read()});
  }
}

void HitErrors::write(nlohmann::json& out) const {
  if (pixels_ == 0) return;
  const std::size_t hits = rays_ - escaped_;
  out["object_pixels"] = pixels_;
  out["escaped_share"] = share(escaped_, rays_);
  out["hidden_share"] = share(hidden_, hits);
  summarise(maps_[kDirection], out);
  if (!seen_deg_.empty()) {
    out["direction_error_deg_median_seen"] = quantile(seen_deg_, 0.5);
    out["direction_error_deg_q95_seen"] = quantile(seen_deg_, 0.95);
  }
  summarise_values(exit_diagonals_, "exit_error_diagonals", out);
  summarise_values(exit_deg_, "exit_direction_error_deg", out);
  summarise(maps_[kHit], out);
  if (lookup_kind_ != RayLookup::search) return;
  out["unconverged_share"] = share(unconverged_, hits);

  std::array<std::size_t, kClasses.size()> counts{};
  std::array<double, kClasses.size()> errors_m{};
  double all_m = 0;
  for (std::size_t i = 0; i < maps_[kClass].values.pixels.size(); ++i) {
    const float of = maps_[kClass].values.pixels[i];
    if (!std::isfinite(of)) continue;
    const double error_m = static_cast<double>(maps_[kHit].values.pixels[i]);
    ++counts[static_cast<std::size_t>(of)];
    errors_m[static_cast<std::size_t>(of)] += error_m;
    all_m += error_m;
  }
  if (hits == 0) return;
  for (std::size_t c = 0; c < kClasses.size(); ++c) {
    const std::string name = std::string("hits_") + kClasses[c];
    out[name + "_share"] = share(counts[c], hits);
    if (counts[c] > 0) out[name + "_error_m_mean"] = errors_m[c] / static_cast<double>(counts[c]);
    if (all_m > 0) out[name + "_error_share"] = errors_m[c] / all_m;
  }
}

}  // namespace pellucid::local_cube_maps
