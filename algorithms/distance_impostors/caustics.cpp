// Szirmay-Kalos et al. 2005 (references.bib: szirmaykalos2005), Sec. 5: caustics.
#include "algorithms/distance_impostors/caustics.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "algorithms/reference/photons/photons.hpp"
#include "algorithms/scene/files/tell.hpp"
#include "gl/context.hpp"

namespace pellucid::distance_impostors {
namespace {

constexpr const char* kVertexStage = "algorithms/shaders/opaque.vert.glsl";
// From nearer than this to the bounding sphere's surface no one frustum sees the object.
constexpr float kWidestHalfAngleDeg = 80;

struct Sphere {
  glm::vec3 center{0.0F};
  float radius = 0;
};
Sphere bounding_sphere(const Scene& scene, const Instance& instance) {
  const std::vector<glm::vec3>& positions = scene.meshes[static_cast<std::size_t>(instance.mesh)].positions;
  glm::vec3 low(std::numeric_limits<float>::infinity()), high(-low);
  for (const glm::vec3& p : positions) {
    const glm::vec3 q(instance.to_world * glm::vec4(p, 1.0F));
    low = glm::min(low, q);
    high = glm::max(high, q);
  }
  if (positions.empty()) return {};
  Sphere sphere{0.5F * (low + high), 0};
  for (const glm::vec3& p : positions)
    sphere.radius =
        std::max(sphere.radius, glm::distance(sphere.center, glm::vec3(instance.to_world * glm::vec4(p, 1.0F))));
  return sphere;
}

glm::vec3 any_perpendicular(const glm::vec3& axis) {
  return std::abs(axis.y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
}

float cosine(float degrees) {
  return std::cos(degrees * std::numbers::pi_v<float> / 180.0F);
}

int exit_count(SurfaceKind kind, const LookupSettings& lookup) {
  if (kind != SurfaceKind::dielectric) return 1;
  return lookup.bounces > 1 ? 2 + lookup.internal : 2;
}

}  // namespace

void Caustics::warn(std::string text) {
  if (std::find(warnings_.begin(), warnings_.end(), text) != warnings_.end()) return;
  tell("warning: {}", text);
  warnings_.push_back(std::move(text));
}

void Caustics::prepare(const Scene& scene, const CausticSettings& settings, const MapSettings& maps,
                       const DynamicObjects& objects) {
  settings_ = settings;
  receivers_ = {};
  places_.clear();
  place_targets_.clear();
  warnings_.clear();
  traced_ = false;
  if (!settings.enabled) return;
  if (std::none_of(scene.lights.begin(), scene.lights.end(), [](const Light& light) { return light.casts_shadow; }))
    warn(fmt::format("scene '{}' has no light that casts shadows, so that there is no caustic", scene.name));

  for (std::string& text : receivers_.prepare(scene, settings.light_map_size))
    warn(std::move(text));

  const int size = settings.map_size;
  photon_framebuffers_.clear();
  const int exits = 10;  // a reflection and up to nine ways out
  photon_places_ = gl::Texture::make_2d_array("photon places", gl::Format::rgba32f, size, size, exits);
  photon_powers_ = gl::Texture::make_2d_array("photon powers", gl::Format::rgba32f, size, size, exits);
  photon_depth_ = gl::Texture::make_2d("photon depth", gl::Format::depth32f, size, size);
  for (int exit = 0; exit < exits; ++exit)
    photon_framebuffers_.push_back(
        gl::Framebuffer::layered("photons", {&photon_places_, &photon_powers_}, &photon_depth_, exit));
  const int layers = std::max(1, receivers_.count());
  light_maps_ = gl::Texture::make_2d_array("light maps", gl::Format::rgba32f, settings.light_map_size,
                                           settings.light_map_size, layers);
  light_maps_.set_sampling(gl::Filter::linear, gl::Wrap::clamp);
  light_maps_.clear({0, 0, 0, 0});
  light_map_framebuffer_ = gl::Framebuffer::layered("light maps", light_maps_, nullptr, -1);
  for (const DynamicObjects::Object& object : objects.objects()) {
    gl::Texture& cube = places_.emplace_back(
        gl::Texture::make_cube("places seen by " + scene.instances[static_cast<std::size_t>(object.instance)].name,
                               gl::Format::rgba32f, maps.cube_size));
    cube.set_sampling(gl::Filter::linear, gl::Wrap::clamp);
  }
  for (std::size_t i = 0; i < places_.size(); ++i)
    place_targets_.emplace_back("places", std::initializer_list<const gl::Texture*>{&places_[i]},
                                &objects.objects()[i].cube->depth());

  const std::string folder = "algorithms/distance_impostors/";
  place_program_ = make_cube_program("places", folder + "place.frag.glsl", maps.layers, {});
  cube_light_program_ =
      make_cube_program("caustic light in a cube", folder + "caustic_light.frag.glsl", maps.layers, {});
  light_program_ = gl::Program("caustic light", {kVertexStage, folder + "caustic_light.frag.glsl"});
  depth_program_ = gl::Program("photon depth", {kVertexStage, "algorithms/local_cube_maps/depth.frag.glsl"});
  splat_program_ =
      gl::Program("splats", {folder + "splat.vert.glsl", folder + "splat.geom.glsl", folder + "splat.frag.glsl"});
  if (points_.id() == 0) points_ = gl::VertexArray("photons");
}

// Over geometry that has been drawn already, with its depth: only what is seen may pass.
static void begin_over_drawn() {
  glDisable(GL_CULL_FACE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_FALSE);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(0.0F, -8.0F);
}
static void end_over_drawn() {
  glDisable(GL_POLYGON_OFFSET_FILL);
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
}

void Caustics::draw_places(const Scene&, const DynamicObjects::Object& object, std::size_t index,
                           const MapSettings& maps) {
  begin_over_drawn();
  glDisable(GL_BLEND);
  places_[index].clear({0, 0, -1, 0});
  place_targets_[index].draw(maps.layers, [&](int face) {
    use_cube_program(place_program_, object.cube->camera(), face);
    receivers_.draw_places(maps.layers == CubeLayers::vertex ? gl::kCubeFaces : 1);
  });
  end_over_drawn();
}

void Caustics::add_light(const DynamicObjects::Object& object, const MapSettings& maps) {
  begin_over_drawn();
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  light_maps_.bind(7);
  object.cube->target().draw(maps.layers, [&](int face) {
    use_cube_program(cube_light_program_, object.cube->camera(), face);
    receivers_.draw_surfaces(maps.layers == CubeLayers::vertex ? gl::kCubeFaces : 1);
  });
  end_over_drawn();
}

void Caustics::draw(const Scene&, const Camera& camera) {
  if (!settings_.enabled || receivers_.empty()) return;
  begin_over_drawn();
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  light_maps_.bind(7);
  light_program_.use();
  light_program_.set("world_to_clip", camera.projection() * camera.world_to_view());
  receivers_.draw_surfaces(1);
  end_over_drawn();
}

bool Caustics::see(const Scene& scene, const Light& light, const DynamicObjects::Object& object, PhotonCamera& camera) {
  const Instance& instance = scene.instances[static_cast<std::size_t>(object.instance)];
  const Sphere sphere = bounding_sphere(scene, instance);
  if (!(sphere.radius > 0)) return false;
  const auto texels = static_cast<float>(settings_.map_size);
  if (light.kind == LightKind::directional) {
    // Whatever stands before the object keeps the light from it, however far away it stands.
    float back = sphere.radius;
    for (const Instance& other : scene.instances) {
      const Sphere there = bounding_sphere(scene, other);
      back = std::max(back, glm::dot(sphere.center - there.center, light.direction) + there.radius);
    }
    const float r = sphere.radius;
    camera.axis = light.direction;
    camera.texel = 2 * r / texels;
    camera.world_to_clip =
        glm::ortho(-r, r, -r, r, 0.0F, back + r) *
        glm::lookAt(sphere.center - back * light.direction, sphere.center, any_perpendicular(light.direction));
    return true;
  }
  const glm::vec3 offset = sphere.center - light.position;
  const float away = glm::length(offset);
  const float widest = std::sin(kWidestHalfAngleDeg * std::numbers::pi_v<float> / 180.0F);
  if (sphere.radius > widest * away) {
    warn(fmt::format("light '{}' lies in '{}' or touches its bounding sphere: this pair's caustic is left out",
                     light.name, instance.name));
    return false;
  }
  const float half = std::asin(sphere.radius / away);
  camera.axis = offset / away;
  camera.texel = 2 * std::tan(half) / texels;
  camera.world_to_clip = glm::perspective(2 * half, 1.0F, 1e-3F * away, away + 1.01F * sphere.radius) *
                         glm::lookAt(light.position, sphere.center, any_perpendicular(camera.axis));
  return true;
}

const gl::Program& Caustics::photon_program(const DynamicObjects& objects, SurfaceKind kind,
                                            const LookupSettings& lookup) {
  gl::Defines defines = objects.defines(kind, lookup);
  Compiled& compiled = photon_programs_[kind];
  if (!compiled.program || compiled.defines != defines) {
    compiled.program =
        gl::Program("photons", {kVertexStage, "algorithms/distance_impostors/photon.frag.glsl"}, defines);
    compiled.defines = std::move(defines);
  }
  return compiled.program;
}

void Caustics::trace(const Scene& scene, const ForwardPass& forward, const DynamicObjects& objects, std::size_t index,
                     const Light& light, const LookupSettings& lookup) {
  const DynamicObjects::Object& object = objects.objects()[index];
  const Instance& instance = scene.instances[static_cast<std::size_t>(object.instance)];
  const SurfaceKind kind = material_of(scene, instance).kind;
  PhotonCamera camera;
  if (!see(scene, light, object, camera)) return;
  const gl::Program& program = photon_program(objects, kind, lookup);
  const int exits = exit_count(kind, lookup);
  for (int exit = 0; exit < exits; ++exit) {
    const gl::Framebuffer& target = photon_framebuffers_[static_cast<std::size_t>(exit)];
    target.bind();
    target.clear_color(0, {0, 0, -1, 0});
    target.clear_color(1, {0, 0, 0, 0});
    glDisable(GL_BLEND);
    if (exit == 0) {
      // Whatever stands between; a shader without outputs leaves undefined colours.
      glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
      forward.draw_geometry(camera.world_to_clip, depth_program_, Objects::all);
      glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    }
    glDisable(GL_CULL_FACE);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    glDepthMask(GL_FALSE);
    objects.bind(scene, object, lookup, program);
    places_[index].bind(8);
    program.set("exit_index", exit - 1);
    program.set("light_kind", static_cast<int>(light.kind));
    program.set("light_position", light.position);
    program.set("light_direction", light.direction);
    program.set("light_intensity", light.intensity);
    program.set("light_cone", glm::vec2(cosine(light.outer_angle_deg), cosine(light.inner_angle_deg)));
    program.set("view_axis", camera.axis);
    program.set("texel", camera.texel);
    forward.draw_instance(scene, object.instance, camera.world_to_clip, program);
  }
  glDepthMask(GL_TRUE);
  splat(exits);
}

void Caustics::splat(int exits) {
  light_map_framebuffer_.bind();
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  photon_places_.bind(9);
  photon_powers_.bind(10);
  splat_program_.use();
  splat_program_.set("map_size", settings_.map_size);
  splat_program_.set("light_map_size", settings_.light_map_size);
  splat_program_.set("sigma", settings_.sigma_texels);
  points_.bind();
  glDrawArraysInstanced(GL_POINTS, 0, settings_.map_size * settings_.map_size, exits);
  glDisable(GL_BLEND);
}

void Caustics::update(const Scene& scene, const ForwardPass& forward, const DynamicObjects& objects,
                      const MapSettings& maps, const LookupSettings& lookup, const std::vector<std::size_t>& due) {
  if (!settings_.enabled || receivers_.empty()) return;
  const bool changed = !traced_ || revision_ != scene.revision();
  if (changed) receivers_.place(scene);
  for (const std::size_t i : due)
    draw_places(scene, objects.objects()[i], i, maps);
  if (changed || settings_.every_frame || !due.empty()) {
    light_maps_.clear({0, 0, 0, 0});
    for (const Light& light : scene.lights) {
      if (!light.casts_shadow) continue;
      for (std::size_t i = 0; i < objects.objects().size(); ++i)
        trace(scene, forward, objects, i, light, lookup);
    }
    traced_ = true;
    revision_ = scene.revision();
  }
  for (const std::size_t i : due)
    add_light(objects.objects()[i], maps);
}

double Caustics::landed_w() const {
  if (!settings_.enabled || receivers_.empty()) return 0;
  double sum = 0;
  const std::vector<float> texels = light_maps_.read();
  for (std::size_t i = 3; i < texels.size(); i += 4)
    sum += static_cast<double>(texels[i]);
  return sum;
}

std::string Caustics::reload_shaders() {
  std::string words;
  for (gl::Program* program :
       {&place_program_, &cube_light_program_, &light_program_, &splat_program_, &depth_program_}) {
    if (*program) words += program->reload();
  }
  for (auto& [kind, compiled] : photon_programs_)
    words += compiled.program.reload();
  return words;
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
