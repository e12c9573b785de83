// Szirmay-Kalos et al. 2005 (references.bib: szirmaykalos2005), Sec. 5: caustics.
#include "algorithms/distance_impostors/caustics.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "algorithms/distance_impostors/light_map_chart.hpp"
#include "gl/context.hpp"

namespace pellucid::distance_impostors {
namespace {

constexpr const char* kVertexStage = "algorithms/shaders/common/opaque.vert.glsl";
constexpr int kPartsPerUnit = 1024;  // a receiver's part is coded behind the binary point of its number
constexpr int kMargin = 2;           // texels around a part
// From nearer than this to the bounding sphere's surface no one frustum sees the object.
constexpr float kWidestHalfAngleDeg = 80;

struct Vertex {
  glm::vec3 position;
  glm::vec3 place;  // u, v, receiver and part
  glm::vec3 color;
};
// As opaque.vert.glsl takes it. Normals stay as they are, since places come in their stead.
struct Attributes {
  glm::mat4 to_world{1.0F};
  glm::vec3 normal_to_world[3]{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  glm::vec3 albedo{0.0F}, emission{0.0F};
};

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
  fmt::print(stderr, "warning: {}\n", text);
  warnings_.push_back(std::move(text));
}

void Caustics::prepare(const Scene& scene, const CausticSettings& settings, const MapSettings& maps,
                       const DynamicObjects& objects) {
  settings_ = settings;
  receivers_.clear();
  places_.clear();
  place_targets_.clear();
  warnings_.clear();
  traced_ = false;
  if (!settings.enabled) return;
  if (std::none_of(scene.lights.begin(), scene.lights.end(), [](const Light& light) { return light.casts_shadow; }))
    warn(fmt::format("scene '{}' has no light that casts shadows, so that there is no caustic", scene.name));

  int left_out = 0;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (optical(scene, instance)) continue;
    const auto chart =
        make_chart(scene.meshes[static_cast<std::size_t>(instance.mesh)], settings.light_map_size, kMargin);
    if (!chart) {
      warn(fmt::format("'{}' receives no caustic: its texture coordinates do not keep its surface apart",
                       scene.meshes[static_cast<std::size_t>(instance.mesh)].name));
    } else if (receivers_.size() < static_cast<std::size_t>(kMaxReceivers)) {
      add_receiver(scene, static_cast<int>(i), *chart);
    } else {
      ++left_out;
    }
  }
  if (left_out > 0)
    warn(fmt::format("{} opaque objects beyond the first {} receive no caustic", left_out, kMaxReceivers));

  const int size = settings.map_size;
  photon_framebuffers_.clear();
  const int exits = 10;  // a reflection and up to nine ways out
  photon_places_ = gl::Texture::make_2d_array("photon places", gl::Format::rgba32f, size, size, exits);
  photon_powers_ = gl::Texture::make_2d_array("photon powers", gl::Format::rgba32f, size, size, exits);
  photon_depth_ = gl::Texture::make_2d("photon depth", gl::Format::depth32f, size, size);
  for (int exit = 0; exit < exits; ++exit)
    photon_framebuffers_.push_back(
        gl::Framebuffer::layered("photons", {&photon_places_, &photon_powers_}, &photon_depth_, exit));
  const int layers = std::max(1, static_cast<int>(receivers_.size()));
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
  depth_program_ = gl::Program("photon depth", {kVertexStage, folder + "depth.frag.glsl"});
  splat_program_ =
      gl::Program("splats", {folder + "splat.vert.glsl", folder + "splat.geom.glsl", folder + "splat.frag.glsl"});
  if (points_.id() == 0) points_ = gl::VertexArray("photons");
}

void Caustics::add_receiver(const Scene& scene, int instance, const LightMapChart& chart) {
  const Instance& object = scene.instances[static_cast<std::size_t>(instance)];
  const Mesh& mesh = scene.meshes[static_cast<std::size_t>(object.mesh)];
  std::vector<Vertex> vertices(mesh.positions.size());
  const auto number = static_cast<float>(receivers_.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const float part = static_cast<float>(chart.parts[i]) / static_cast<float>(kPartsPerUnit);
    vertices[i] = {mesh.positions[i], glm::vec3(chart.places[i], number + part),
                   mesh.colors.empty() ? glm::vec3(1) : mesh.colors[i]};
  }
  Receiver& receiver = receivers_.emplace_back();
  receiver.instance = instance;
  receiver.places = chart.places;
  receiver.index_count = static_cast<int>(mesh.triangles.size() * 3);
  receiver.vertices = gl::Buffer("receiver vertices", std::span<const Vertex>(vertices));
  receiver.indices = gl::Buffer("receiver indices", std::span<const glm::uvec3>(mesh.triangles));
  receiver.attributes = gl::Buffer("receiver attributes", sizeof(Attributes), GL_DYNAMIC_DRAW);
  receiver.unshaded = gl::Buffer("receiver place", sizeof(Attributes), GL_DYNAMIC_DRAW);
  receiver.densities = gl::Buffer("receiver densities", vertices.size() * sizeof(Vertex), GL_DYNAMIC_DRAW);
  const auto make_array = [&](const gl::Buffer& buffer, const gl::Buffer& attributes) {
    gl::VertexArray array(
        "receiver", buffer, sizeof(Vertex),
        {{0, 3, offsetof(Vertex, position)}, {1, 3, offsetof(Vertex, place)}, {2, 3, offsetof(Vertex, color)}},
        &receiver.indices);
    const std::size_t normals = offsetof(Attributes, normal_to_world);
    array.add_instanced(attributes, sizeof(Attributes),
                        {{3, 4, 0},
                         {4, 4, sizeof(glm::vec4)},
                         {5, 4, 2 * sizeof(glm::vec4)},
                         {6, 4, 3 * sizeof(glm::vec4)},
                         {7, 3, normals},
                         {8, 3, normals + sizeof(glm::vec3)},
                         {9, 3, normals + 2 * sizeof(glm::vec3)},
                         {10, 3, offsetof(Attributes, albedo)},
                         {11, 3, offsetof(Attributes, emission)}});
    return array;
  };
  receiver.array = make_array(receiver.vertices, receiver.attributes);
  receiver.place_array = make_array(receiver.densities, receiver.unshaded);
}

void Caustics::place_receivers(const Scene& scene) {
  for (std::size_t r = 0; r < receivers_.size(); ++r) {
    Receiver& receiver = receivers_[r];
    const Instance& instance = scene.instances[static_cast<std::size_t>(receiver.instance)];
    Attributes attributes;
    attributes.to_world = instance.to_world;
    attributes.albedo = glm::vec3(1);
    receiver.unshaded.upload(std::span<const Attributes>(&attributes, 1));
    attributes.albedo = scene.materials[static_cast<std::size_t>(instance.material)].albedo * instance.tint;
    receiver.attributes.upload(std::span<const Attributes>(&attributes, 1));
    if (const glm::mat3 axes(instance.to_world); axes != receiver.axes) measure_density(scene, receiver, axes);
  }
}

// About a vertex: the area of its triangles over the area that they take of the light map.
void Caustics::measure_density(const Scene& scene, Receiver& receiver, const glm::mat3& axes) {
  const Instance& instance = scene.instances[static_cast<std::size_t>(receiver.instance)];
  const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
  std::vector<double> area(mesh.positions.size(), 0), taken(mesh.positions.size(), 0);
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::vec3 ab = axes * (mesh.positions[t.y] - mesh.positions[t.x]);
    const glm::vec3 ac = axes * (mesh.positions[t.z] - mesh.positions[t.x]);
    const glm::vec2 uv = receiver.places[t.y] - receiver.places[t.x], uw = receiver.places[t.z] - receiver.places[t.x];
    for (int i = 0; i < 3; ++i) {
      area[t[i]] += static_cast<double>(glm::length(glm::cross(ab, ac)));
      taken[t[i]] += static_cast<double>(std::abs(uv.x * uw.y - uv.y * uw.x));
    }
  }
  std::vector<Vertex> vertices(mesh.positions.size());
  const std::vector<std::byte> drawn = receiver.vertices.read();
  std::memcpy(vertices.data(), drawn.data(), drawn.size());
  for (std::size_t i = 0; i < vertices.size(); ++i)
    vertices[i].color = glm::vec3(taken[i] > 0 ? static_cast<float>(area[i] / taken[i]) : 0.0F);
  receiver.densities.upload(std::span<const Vertex>(vertices));
  receiver.axes = axes;
}

void Caustics::draw_receivers(gl::VertexArray Receiver::*array, int copies) const {
  constexpr GLuint kInstanceBinding = 1;
  for (const Receiver& receiver : receivers_) {
    (receiver.*array).bind();
    glVertexArrayBindingDivisor((receiver.*array).id(), kInstanceBinding, static_cast<GLuint>(copies));
    glDrawElementsInstanced(GL_TRIANGLES, receiver.index_count, GL_UNSIGNED_INT, nullptr, copies);
  }
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
    draw_receivers(&Receiver::place_array, maps.layers == CubeLayers::vertex ? gl::kCubeFaces : 1);
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
    draw_receivers(&Receiver::array, maps.layers == CubeLayers::vertex ? gl::kCubeFaces : 1);
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
  draw_receivers(&Receiver::array, 1);
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
  const SurfaceKind kind = scene.materials[static_cast<std::size_t>(instance.material)].kind;
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
  if (changed) place_receivers(scene);
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

std::vector<int> Caustics::receivers() const {
  std::vector<int> instances;
  for (const Receiver& receiver : receivers_)
    instances.push_back(receiver.instance);
  return instances;
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

}  // namespace pellucid::distance_impostors
