// Szirmay-Kalos et al. 2005 (references.bib: szirmaykalos2005), Sec. 6: every dynamic object with its own maps.
#include "algorithms/local_cube_maps/dynamic_objects.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "algorithms/scene/shapes/bounds.hpp"

namespace pellucid::local_cube_maps {
namespace {

constexpr const char* kFolder = "algorithms/local_cube_maps/";

const Instance& instance_of(const Scene& scene, const DynamicObjects::Object& object) {
  return scene.instances[static_cast<std::size_t>(object.instance)];
}

// Around the opaque objects: what the proxies stand for.
Bounds opaque_bounds(const Scene& scene) {
  Bounds all;
  bool any = false;
  for (const Instance& instance : scene.instances) {
    if (optical(scene, instance)) continue;
    const Bounds bounds = mesh_bounds(scene.meshes[static_cast<std::size_t>(instance.mesh)]);
    for (int i = 0; i < 8; ++i) {
      const glm::vec3 p(instance.to_world * glm::vec4(bounds.corner(i), 1.0F));
      all.min = any ? glm::min(all.min, p) : p;
      all.max = any ? glm::max(all.max, p) : p;
      any = true;
    }
  }
  return any ? all : world_bounds(scene);
}

}  // namespace

void DynamicObjects::prepare(const Scene& scene, const MapSettings& settings, const LookupSettings& lookup,
                             const char* technique) {
  objects_.clear();
  refractors_.clear();
  extents_.clear();
  warnings_.clear();
  cost_ = {};
  cost_timer_.emplace(gl::Detail::frame);
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (!optical(scene, instance)) continue;
    Object& object = objects_.emplace_back();
    object.instance = static_cast<int>(i);
    object.cube = std::make_unique<ImpostorCube>(instance.name + " cube", settings);
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
    const Bounds bounds = mesh_bounds(mesh);
    if (!extents_.contains(instance.mesh))
      extents_[instance.mesh] = {0.5F * (bounds.min + bounds.max), 0.5F * (bounds.max - bounds.min), closed(mesh)};
    if (lookup.bounces < 2 || material_of(scene, object.instance).kind != SurfaceKind::dielectric) continue;
    const auto [at, made] = refractors_.try_emplace(instance.mesh, mesh, settings.refractor_size, settings.layers);
    object.refractor = &at->second;
    if (made && !at->second.shape().exact()) warnings_.push_back(describe(mesh.name, at->second.shape()));
  }
  if (lookup.translucency && lookup.bounces > 1) translucency_.prepare(scene, *lookup.translucency);
  if (objects_.empty())
    throw InputError(fmt::format("{}: scene '{}' has no mirror, metal or dielectric", technique, scene.name));
  const Bounds proxy = opaque_bounds(scene);
  proxy_min_ = proxy.min;
  proxy_max_ = proxy.max;
}

glm::vec3 DynamicObjects::center(const Scene& scene, const Object& object) const {
  const Instance& instance = instance_of(scene, object);
  return glm::vec3(instance.to_world * glm::vec4(extents_.at(instance.mesh).middle, 1.0F));
}

void DynamicObjects::cull(const Scene& scene, const Object& object, const glm::vec3& eye) const {
  const Instance& instance = instance_of(scene, object);
  const Extent& extent = extents_.at(instance.mesh);
  const glm::vec3 local(glm::inverse(instance.to_world) * glm::vec4(eye, 1.0F));
  // A margin for the near plane, which may cut into an object that the eye is close to.
  const glm::vec3 off = glm::abs(local - extent.middle) - 1.5F * extent.half;
  if (extent.closed && (off.x > 0 || off.y > 0 || off.z > 0)) {
    glEnable(GL_CULL_FACE);
    glCullFace(glm::determinant(glm::mat3(instance.to_world)) > 0 ? GL_BACK : GL_FRONT);
  } else {
    glDisable(GL_CULL_FACE);
  }
}

glm::vec3 DynamicObjects::anchor(const Scene& scene, const Object& object, const MapSettings& settings) const {
  switch (settings.anchor) {
    case Anchor::object:
      return center(scene, object);
    case Anchor::scene:
      return 0.5F * (proxy_min_ + proxy_max_);
    case Anchor::point:
      break;
  }
  return settings.anchor_point;
}

std::vector<std::size_t> DynamicObjects::due(const Scene& scene, const MapSettings& settings) {
  const auto now = std::chrono::steady_clock::now();
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    Object& object = objects_[i];
    const glm::vec3 at = anchor(scene, object, settings);
    bool again = !object.drawn;
    if (settings.refresh == Refresh::frames)
      again = again || cost_.frames - object.frame >= static_cast<std::uint64_t>(settings.refresh_frames);
    if (settings.refresh == Refresh::interval)
      again = again || std::chrono::duration<float, std::milli>(now - object.time).count() >= settings.refresh_ms;
    if (settings.refresh == Refresh::movement)
      again = again || glm::distance(at, object.reference) > settings.refresh_distance_m;
    if (!again) continue;
    object.reference = at;
    object.frame = cost_.frames;
    object.time = now;
    object.drawn = true;
    which.push_back(i);
  }
  ++cost_.frames;
  cost_.refreshes += which.size();
  return which;
}

void DynamicObjects::draw_maps(const Scene& scene, const ForwardPass& forward, const MapSettings& settings,
                               const LookupSettings&, const std::vector<std::size_t>& which) {
  for (const std::size_t i : which)
    objects_[i].cube->draw(cube_scene_, forward, CubeCamera::around(scene, objects_[i].reference, settings.layers));
}

void DynamicObjects::draw_mutual(const Scene& scene, const ForwardPass& forward, const MapSettings& settings,
                                 const LookupSettings& lookup, const std::vector<std::size_t>& which) {
  if (objects_.size() < 2) return;
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LEQUAL);
  for (int round = 0; round < settings.mutual; ++round) {
    for (const std::size_t i : which) {
      const ImpostorCube& cube = *objects_[i].cube;
      cube.target().draw(settings.layers, [&](int face) {
        for (std::size_t j = 0; j < objects_.size(); ++j) {
          if (j == i) continue;
          const gl::Program& shade = bound(scene, objects_[j], Use::cube, settings, lookup);
          cull(scene, objects_[j], cube.camera().center);
          draw_cube_object(forward, scene, objects_[j].instance, cube.camera(), face, shade);
        }
      });
    }
  }
  glDisable(GL_CULL_FACE);
}

std::optional<PixelArea> DynamicObjects::seen(const Scene& scene, const Object& object, const Camera& camera) const {
  const Instance& instance = instance_of(scene, object);
  const Extent& extent = extents_.at(instance.mesh);
  return seen_area(camera.projection() * camera.world_to_view() * instance.to_world,
                   {extent.middle - extent.half, extent.middle + extent.half}, camera.width, camera.height);
}

void DynamicObjects::draw_surfaces(const Scene& scene, const ForwardPass& forward, const Camera& camera,
                                   const Target& target) {
  pixels_.begin(target.depth);
  // All of them before the first object: areas may overlap.
  for (const Object& object : objects_) {
    if (const auto area = seen(scene, object, camera)) pixels_.clear(*area);
  }
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LEQUAL);
  const glm::mat4 world_to_clip = camera.projection() * camera.world_to_view();
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    if (!seen(scene, objects_[i], camera)) continue;
    cull(scene, objects_[i], camera.view.eye);
    forward.draw_instance(scene, objects_[i].instance, world_to_clip,
                          pixels_.surfaces(camera, static_cast<int>(i) + 1));
  }
  glDisable(GL_CULL_FACE);
}

void DynamicObjects::shade(const Scene& scene, const Camera& camera, const Target& target, const MapSettings& settings,
                           const LookupSettings& lookup) {
  target.framebuffer.bind();
  glDisable(GL_BLEND);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const auto area = seen(scene, objects_[i], camera);
    if (!area) continue;
    const gl::Program& shading = bound(scene, objects_[i], Use::frame, settings, lookup);
    pixels_.bind(shading, camera, static_cast<int>(i) + 1);
    shading.use();
    pixels_.fill(*area);
  }
}

void DynamicObjects::draw(const Scene& scene, const ForwardPass& forward, const Camera& camera, const Target& target,
                          const MapSettings& settings, const LookupSettings& lookup) {
  draw_surfaces(scene, forward, camera, target);
  shade(scene, camera, target, settings, lookup);
}

void DynamicObjects::draw_report(const Scene& scene, const ForwardPass& forward, const Camera& camera,
                                 const MapSettings& settings, const LookupSettings& lookup, const Object& object) {
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LEQUAL);
  const gl::Program& shade = bound(scene, object, Use::report, settings, lookup);
  shade.set("eye", camera.view.eye);
  forward.draw_instance(scene, object.instance, camera.projection() * camera.world_to_view(), shade);
}

gl::Defines DynamicObjects::defines(SurfaceKind kind, const LookupSettings& lookup) const {
  gl::Defines defines{{"KIND", fmt::to_string(static_cast<int>(kind))},
                      {"PARALLAX", fmt::to_string(static_cast<int>(lookup.kind))}};
  const bool refractor = kind == SurfaceKind::dielectric && lookup.bounces > 1;
  if (lookup.kind == RayLookup::search || refractor) {
    defines.emplace_back("ITERATIONS", fmt::to_string(lookup.search.iterations));
    defines.emplace_back("SCHEME", fmt::to_string(static_cast<int>(lookup.search.scheme)));
    defines.emplace_back("LINEAR_STEPS", fmt::to_string(lookup.search.steps));
    if (lookup.bare) defines.emplace_back("BARE", fmt::to_string(fetches(lookup.search)));
  }
  if (kind == SurfaceKind::dielectric)
    defines.emplace_back("INTERNAL", fmt::to_string(refractor ? lookup.internal : 0));
  if (refractor) defines.emplace_back("REFRACTOR", "1");
  return defines;
}

const gl::Program& DynamicObjects::bound(const Scene& scene, const Object& object, Use use, const MapSettings& settings,
                                         const LookupSettings& lookup) {
  const Material& material = material_of(scene, object.instance);
  const gl::Program& result = program(scene, material.kind, use, settings, lookup);
  bind(scene, object, lookup, result);
  if (use != Use::report && object.refractor != nullptr && lookup.translucency)
    translucency_.bind(result, scene, material);
  return result;
}

const gl::Program& DynamicObjects::program(const Scene& scene, SurfaceKind kind, Use use, const MapSettings& settings,
                                           const LookupSettings& lookup) {
  gl::Defines wanted = defines(kind, lookup);
  if (use != Use::report && kind == SurfaceKind::dielectric && lookup.bounces > 1 && lookup.translucency) {
    const gl::Defines medium = Translucency::defines(scene, lookup.translucency->model);
    wanted.insert(wanted.end(), medium.begin(), medium.end());
  }
  if (use == Use::cube) {
    if (settings.store == DistanceStore::alpha) wanted.emplace_back("DISTANCE_IN_ALPHA", "1");
    wanted.emplace_back("LAYERS", fmt::to_string(static_cast<int>(settings.layers)));
  }
  if (use == Use::frame) wanted.emplace_back("FROM_PIXELS", "1");
  Compiled& compiled = programs_[{kind, use}];
  if (compiled.program && compiled.defines == wanted) return compiled.program;
  const std::string fragment = std::string(kFolder) + (use == Use::report ? "report.frag.glsl" : "surface.frag.glsl");
  const std::string shared = "algorithms/shaders/";
  if (use == Use::cube)
    compiled.program = make_cube_program("optical object in a cube", fragment, settings.layers, wanted);
  else
    compiled.program =
        gl::Program("optical object",
                    {shared + (use == Use::frame ? "fullscreen.vert.glsl" : "opaque.vert.glsl"), fragment}, wanted);
  compiled.defines = std::move(wanted);
  return compiled.program;
}

void DynamicObjects::bind(const Scene& scene, const Object& object, const LookupSettings& lookup,
                          const gl::Program& program) const {
  const Material& material = material_of(scene, object.instance);
  object.cube->bind();
  program.set("reference_point", object.reference);
  program.set("reflectance", material.reflectance);
  program.set("metal_n", material.metal_n);
  program.set("metal_k", material.metal_k);
  program.set("ior", material.ior);
  program.set("absorption", material.absorption);
  if (lookup.kind == RayLookup::box) {
    program.set("proxy_min", proxy_min_ - object.reference);
    program.set("proxy_max", proxy_max_ - object.reference);
  }
  if (lookup.kind == RayLookup::sphere) {
    const glm::vec3 half = 0.5F * (proxy_max_ - proxy_min_);
    program.set("proxy_radius", lookup.proxy_radius_m > 0 ? lookup.proxy_radius_m : (half.x + half.y + half.z) / 3.0F);
  }
  if (object.refractor == nullptr || lookup.bounces < 2) return;
  object.refractor->bind();
  const glm::mat4 to_world = instance_of(scene, object).to_world;
  glm::mat4 from_center(1.0F);
  from_center[3] = glm::vec4(object.refractor->center(), 1.0F);
  program.set("map_to_world", to_world * from_center);
  program.set("world_to_map", glm::inverse(to_world * from_center));
}

const DynamicObjects::Cost& DynamicObjects::cost() {
  while (const auto time = cost_timer_ ? cost_timer_->poll() : std::nullopt) {
    cost_.last_ms = time->frame_ms;
    cost_.total_ms += time->frame_ms;
    ++cost_.timed;
  }
  return cost_;
}

std::string DynamicObjects::reload_shaders() {
  std::string words = cube_scene_.reload_shaders() + pixels_.reload_shaders();
  for (auto& [key, compiled] : programs_) {
    if (compiled.program) words += compiled.program.reload();
  }
  return words;
}

}  // namespace pellucid::local_cube_maps
