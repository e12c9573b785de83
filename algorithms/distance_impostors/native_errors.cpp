#include "algorithms/distance_impostors/native_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <nlohmann/json.hpp>

#include "algorithms/reference/interfaces.hpp"
#include "algorithms/reference/photons.hpp"

namespace pellucid::distance_impostors {
namespace {

constexpr double kConverged = 0.01;  // | |l| / |l'| − 1 |
constexpr double kOffset = 1e-4;     // of the hit's distance, before a point counts as hidden

struct Errors {
  std::vector<double> hit_m, direction_deg, seen_deg, exit_diagonals, exit_deg;
  std::size_t rays = 0, unconverged = 0, hidden = 0, escaped = 0, total = 0;
};

double quantile(std::vector<double>& values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

void summarise(std::vector<double>& values, const std::string& name, nlohmann::json& out) {
  if (values.empty()) return;
  double sum = 0;
  for (const double v : values)
    sum += v;
  out[name + "_mean"] = sum / static_cast<double>(values.size());
  out[name + "_median"] = quantile(values, 0.5);
  out[name + "_q95"] = quantile(values, 0.95);
}

double angle_deg(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180.0 / std::numbers::pi;
}

glm::dvec3 xyz(const float* texel) {
  return {static_cast<double>(texel[0]), static_cast<double>(texel[1]), static_cast<double>(texel[2])};
}

// Where a refracted ray leaves the object, and in which direction, beside the exact way through it.
void compare_exit(const InterfaceTracer& tracer, const Camera& camera, std::size_t pixel, int instance,
                  const glm::dvec3& from, const glm::dvec3& R, Errors& errors) {
  // GL's rows start at the bottom, the tracer's at the top.
  const auto width = static_cast<std::size_t>(camera.width);
  const int x = static_cast<int>(pixel % width), y = camera.height - 1 - static_cast<int>(pixel / width);
  const InterfaceHit entry = tracer.primary(camera, x, y);
  if (entry.instance != instance || !entry.front) return;
  const InnerPath path = tracer.through(entry, camera.ray_direction(x + 0.5, y + 0.5), 0);
  if (path.vertices.empty() || !path.vertices.front().leaving) return;
  const InnerVertex& exit = path.vertices.front();
  errors.exit_diagonals.push_back(glm::distance(from, exit.hit.position) / tracer.diagonal_m(instance));
  errors.exit_deg.push_back(angle_deg(R, *exit.leaving));
}

// One object's pixels. The environment is everything but the object itself, as in its maps.
void compare(const DynamicObjects::Object& object, const InterfaceTracer& tracer, const Camera& camera,
             const std::vector<float>& origins, const std::vector<float>& directions, const std::vector<float>& hits,
             const LookupSettings& lookup, Errors& errors) {
  const bool has_point = lookup.parallax != Parallax::none;
  const glm::dvec3 o(object.reference);
  for (std::size_t i = 0; i < origins.size(); i += 4) {
    if (origins[i + 3] < 0.5F) continue;
    ++errors.total;
    if (hits[i + 3] < 0.5F) continue;  // total reflection: this ray leaves nothing
    const glm::dvec3 x = xyz(&origins[i]), R = glm::normalize(xyz(&directions[i])), l = xyz(&hits[i]);
    if (object.refractor != nullptr && lookup.bounces > 1)
      compare_exit(tracer, camera, i / 4, object.instance, x, R, errors);
    const InterfaceHit hit = tracer.nearest_without(x, R, object.instance);
    ++errors.rays;
    if (!hit) {
      ++errors.escaped;
      continue;
    }
    const glm::dvec3 q = x + R * hit.distance_m, to_q = q - o;
    const double away = glm::length(to_q), turn = angle_deg(l - o, to_q);
    const bool hidden =
        away > 0 && tracer.nearest_without(o, to_q / away, object.instance).distance_m < away * (1 - kOffset) - kOffset;
    errors.direction_deg.push_back(turn);
    if (hidden)
      ++errors.hidden;
    else
      errors.seen_deg.push_back(turn);
    if (!has_point) continue;
    errors.hit_m.push_back(glm::distance(l, q));
    const double ratio = glm::length(l - o) / static_cast<double>(directions[i + 3]);
    if (!(std::abs(ratio - 1) < kConverged)) ++errors.unconverged;
  }
}

}  // namespace

void compare_hits(DynamicObjects& objects, const Scene& scene, const ForwardPass& forward, const Camera& camera,
                  const MapSettings& maps, const LookupSettings& lookup, nlohmann::json& out) {
  const auto make = [&](const char* name) {
    return gl::Texture::make_2d(name, gl::Format::rgba32f, camera.width, camera.height);
  };
  const gl::Texture origin = make("ray origins"), direction = make("ray directions"), hit = make("ray hits");
  const gl::Texture depth = gl::Texture::make_2d("ray depth", gl::Format::depth32f, camera.width, camera.height);
  const gl::Framebuffer framebuffer("rays", {&origin, &direction, &hit}, &depth);
  // What stands before the objects, without a colour.
  const gl::Program covers(
      "rays' depth", {"algorithms/shaders/common/opaque.vert.glsl", "algorithms/distance_impostors/depth.frag.glsl"});
  const InterfaceTracer tracer(scene);
  Errors errors;
  for (const DynamicObjects::Object& object : objects.objects()) {
    framebuffer.bind();
    for (int i = 0; i < 3; ++i)
      framebuffer.clear_color(i, {0, 0, 0, 0});
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    forward.draw_geometry(camera.projection() * camera.world_to_view(), covers, Objects::all);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    objects.draw_report(scene, forward, camera, maps, lookup, object);
    compare(object, tracer, camera, origin.read(), direction.read(), hit.read(), lookup, errors);
  }
  if (errors.total == 0) return;
  const auto share = [](std::size_t part, std::size_t whole) {
    return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
  };
  const std::size_t hits = errors.rays - errors.escaped;
  out["object_pixels"] = errors.total;
  out["escaped_share"] = share(errors.escaped, errors.rays);
  out["hidden_share"] = share(errors.hidden, hits);
  summarise(errors.direction_deg, "direction_error_deg", out);
  if (!errors.seen_deg.empty()) {
    out["direction_error_deg_median_seen"] = quantile(errors.seen_deg, 0.5);
    out["direction_error_deg_q95_seen"] = quantile(errors.seen_deg, 0.95);
  }
  summarise(errors.exit_diagonals, "exit_error_diagonals", out);
  summarise(errors.exit_deg, "exit_direction_error_deg", out);
  if (lookup.parallax == Parallax::none) return;
  summarise(errors.hit_m, "hit_error_m", out);
  if (lookup.parallax == Parallax::impostor) out["unconverged_share"] = share(errors.unconverged, hits);
}

void compare_caustics(const Caustics& caustics, const Scene& scene, nlohmann::json& out) {
  PhotonOptions options;
  options.photons = std::uint64_t{1} << 17U;
  const Photons photons = trace_photons(scene, {}, options);
  const auto mean = [](const glm::dvec3& v) { return (v.x + v.y + v.z) / 3; };
  const double landed = caustics.landed_w(), reference = mean(photons.landed.mean);
  out["caustic_landed_w"] = landed;
  out["caustic_reference_w"] = reference;
  // Channels err alike: the mean of the errors bounds the error of the mean.
  out["caustic_reference_standard_error_w"] = mean(photons.landed.standard_error);
  if (reference > 0) out["caustic_energy_ratio"] = landed / reference;
}

}  // namespace pellucid::distance_impostors
