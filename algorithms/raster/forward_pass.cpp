#include "algorithms/raster/forward_pass.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace pellucid {
namespace {

// The culled instances of all cameras and lights of a frame are kept: a point light has six.
constexpr std::size_t kKeptViews = 1 + 6 * kMaxLights;

// Nothing of the box can be seen when all its corners lie beyond one plane of the clip volume. The far plane is left
// out, since the background lies on it.
bool outside(const glm::mat4& to_clip, const Bounds& bounds) {
  std::array<int, 5> beyond{};
  for (int i = 0; i < 8; ++i) {
    const glm::vec4 p = to_clip * glm::vec4(bounds.corner(i), 1.0F);
    beyond[0] += p.x < -p.w ? 1 : 0;
    beyond[1] += p.x > p.w ? 1 : 0;
    beyond[2] += p.y < -p.w ? 1 : 0;
    beyond[3] += p.y > p.w ? 1 : 0;
    beyond[4] += p.z < -p.w ? 1 : 0;
  }
  return std::find(beyond.begin(), beyond.end(), 8) != beyond.end();
}

// lighting.glsl's std140 block.
struct LightBlock {
  struct Entry {
    glm::vec4 position_kind, direction_outer, intensity_inner;
  } lights[kMaxLights];
  glm::vec4 ambient_count;
};

}  // namespace

ForwardPass::ForwardPass(const Scene& scene)
    : lights_("lights", sizeof(LightBlock), GL_DYNAMIC_DRAW), fullscreen_("fullscreen") {
  upload_meshes(scene);
  gather_instances(scene);
  upload_lights(scene);
  upload_environment(scene);
  revision_ = scene.revision();
}

void ForwardPass::update(const Scene& scene, bool meshes) {
  if (scene.revision() == revision_ && !meshes) return;
  revision_ = scene.revision();
  if (meshes) upload_meshes(scene);
  gather_instances(scene);
  upload_lights(scene);
  upload_environment(scene);
}

void ForwardPass::upload_meshes(const Scene& scene) {
  meshes_.clear();
  mesh_names_.clear();
  for (const Mesh& mesh : scene.meshes) {
    std::vector<ObjectVertex> vertices(mesh.positions.size());
    Vertices out;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      vertices[i] = {mesh.positions[i], mesh.normals[i], mesh.colors.empty() ? glm::vec3(1.0F) : mesh.colors[i]};
    out.bounds = mesh_bounds(mesh);
    out.vertices = gl::Buffer(mesh.name + " vertices", std::span<const ObjectVertex>(vertices));
    out.indices = gl::Buffer(mesh.name + " indices", std::span<const glm::uvec3>(mesh.triangles));
    out.index_count = static_cast<int>(mesh.triangles.size() * 3);
    meshes_.push_back(std::move(out));
    mesh_names_.push_back(mesh.name);
  }
}

void ForwardPass::gather_instances(const Scene& scene) {
  lambertian_.assign(scene.meshes.size(), {});
  optical_.assign(scene.meshes.size(), {});
  visible_.clear();
  alone_.clear();
  everything_.clear();
  for (const Instance& instance : scene.instances)
    (optical(scene, instance) ? optical_ : lambertian_)[static_cast<std::size_t>(instance.mesh)].push_back(
        attributes(scene, instance));
}

InstanceAttributes ForwardPass::attributes(const Scene& scene, const Instance& instance) {
  const Material& material = material_of(scene, instance);
  const glm::mat3 normal_to_world = glm::transpose(glm::inverse(glm::mat3(instance.to_world)));
  return {instance.to_world,
          {normal_to_world[0], normal_to_world[1], normal_to_world[2]},
          material.albedo * instance.tint,
          material.emission};
}

ForwardPass::Batch ForwardPass::make_batch(std::size_t mesh, std::span<const InstanceAttributes> instances) const {
  Batch batch;
  batch.instance_count = static_cast<int>(instances.size());
  batch.instances = gl::Buffer(mesh_names_[mesh] + " instances", instances);
  batch.array = make_object_array(mesh_names_[mesh], meshes_[mesh].vertices, meshes_[mesh].indices, batch.instances);
  return batch;
}

// Instances outside the view are left out once for a view, not in every pass: a software rasteriser spends more on
// their vertices than on all that is seen.
const ForwardPass::Visible& ForwardPass::visible(const glm::mat4& world_to_clip, Objects objects) const {
  for (const Visible& kept : visible_) {
    if (kept.objects != objects || kept.world_to_clip != world_to_clip) continue;
    kept.used_in = frame_;
    return kept;
  }
  if (visible_.size() >= kKeptViews) visible_.erase(visible_.begin());
  Visible& out = visible_.emplace_back();
  out.world_to_clip = world_to_clip;
  out.objects = objects;
  out.used_in = frame_;
  out.batches.resize(meshes_.size());
  std::vector<InstanceAttributes> seen;
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    seen.clear();
    for (const auto* group : {&lambertian_, &optical_}) {
      if (objects == (group == &lambertian_ ? Objects::optical : Objects::lambertian)) continue;
      for (const InstanceAttributes& instance : (*group)[m]) {
        if (!outside(world_to_clip * instance.to_world, meshes_[m].bounds)) seen.push_back(instance);
      }
    }
    if (!seen.empty()) out.batches[m] = make_batch(m, seen);
  }
  return out;
}

void ForwardPass::end_frame() {
  const auto unused = [this](const auto& gathered) { return gathered.used_in < frame_; };
  std::erase_if(visible_, unused);
  std::erase_if(alone_, [&](const auto& entry) { return unused(entry.second); });
  std::erase_if(everything_,
                [&](const auto& entry) { return std::all_of(entry.second.begin(), entry.second.end(), unused); });
  ++frame_;
}

void ForwardPass::upload_lights(const Scene& scene) {
  LightBlock block{};
  uniform_lighting_ = true;
  shadowed_ = false;
  uniform_incident_ = scene.ambient;
  auto cosine = [](float degrees) { return std::cos(degrees * std::numbers::pi_v<float> / 180.0F); };
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    // The cosines of a narrow cone may round to one number, and from that to itself there is no smoothstep: a tenth of
    // a degree lie between its edges.
    const float inner = cosine(light.inner_angle_deg);
    const float outer = std::min(cosine(light.outer_angle_deg), inner - 0x1p-19F);
    block.lights[i] = {glm::vec4(light.position, static_cast<float>(light.kind)), glm::vec4(light.direction, outer),
                       glm::vec4(light.intensity, inner)};
    uniform_lighting_ = uniform_lighting_ && light.kind == LightKind::directional;
    shadowed_ = shadowed_ || light.casts_shadow;
    uniform_incident_ += light.intensity / (4.0F * std::numbers::pi_v<float>);
  }
  block.ambient_count = glm::vec4(scene.ambient, static_cast<float>(scene.lights.size()));
  lights_.upload(std::span<const LightBlock>(&block, 1));
  compile(scene.lights);
}

void ForwardPass::compile(const std::vector<Light>& lights) {
  const std::vector<int> layers = shadow_layers(lights);
  // One entry for each light that there may be: GLSL has no empty arrays.
  std::string kinds, first_layers, beyond_map;
  for (std::size_t i = 0; i < kMaxLights; ++i) {
    const char* comma = i == 0 ? "" : ", ";
    const bool given = i < lights.size();
    kinds.append(comma).append(std::to_string(given ? static_cast<int>(lights[i].kind) : 0));
    first_layers.append(comma).append(std::to_string(given ? layers[i] : -1));
    beyond_map.append(comma).append(given && lit_beyond_map(lights[i]) ? "true" : "false");
  }
  gl::Defines defines{{"LIGHT_COUNT", std::to_string(lights.size())}, {"LIGHT_KINDS", kinds}};
  if (shadowed_) {
    defines.insert(defines.end(), {{"SHADOWS", "1"}, {"SHADOW_LAYERS", first_layers}, {"LIT_BEYOND_MAP", beyond_map}});
  } else if (uniform_lighting_) {
    defines.emplace_back("UNIFORM_SOURCE", "1");
  }
  if (opaque_ && defines == light_defines_) return;
  opaque_ =
      gl::Program("opaque", {"algorithms/shaders/opaque.vert.glsl", "algorithms/shaders/opaque.frag.glsl"}, defines);
  light_defines_ = std::move(defines);
}

void ForwardPass::update_shadows(const Scene& scene, const ShadowSettings& settings) {
  if (!shadowed_) return;
  if (settings.refresh == ShadowRefresh::changed && shadow_revision_ == revision_) return;
  shadows_.update(scene, settings, [&](const glm::mat4& world_to_clip, const gl::Program& program) {
    draw_geometry(world_to_clip, program, Objects::all);
  });
  shadow_revision_ = revision_;
}

void ForwardPass::upload_environment(const Scene& scene) {
  const Environment& environment = scene.environment;
  gradient_ = environment;
  gradient_.image.reset();
  if (environment.image && !environment_) {
    const Image& image = *environment.image;
    // GL's rows start at the bottom, the image's at the top.
    std::vector<float> texels(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 4, 1.0F);
    float* out = texels.data();
    for (int y = image.height - 1; y >= 0; --y) {
      for (int x = 0; x < image.width; ++x, out += 4) {
        const float* in = image.at(x, y);
        for (int c = 0; c < 3; ++c)
          out[c] = in[image.channels >= 3 ? c : 0];
      }
    }
    environment_ = gl::Texture::make_2d("environment", gl::Format::rgba32f, image.width, image.height);
    environment_.upload(texels);
    environment_.set_sampling(gl::Filter::linear, gl::Wrap::repeat);
  }
  if (!background_) {
    background_ = gl::Program("background",
                              {"algorithms/shaders/fullscreen.vert.glsl", "algorithms/shaders/background.frag.glsl"},
                              environment_defines());
  }
}

gl::Defines ForwardPass::environment_defines() const {
  return environment_ ? gl::Defines{{"ENVIRONMENT_IMAGE", "1"}} : gl::Defines{};
}

void ForwardPass::bind_environment(const gl::Program& program) const {
  program.set("radiance_scale", gradient_.scale);
  program.set("zenith", gradient_.zenith);
  program.set("horizon", gradient_.horizon);
  program.set("ground", gradient_.ground);
  if (environment_) environment_.bind(0);
}

void ForwardPass::draw_visible(const glm::mat4& world_to_clip, Objects objects) const {
  const Visible& seen = visible(world_to_clip, objects);
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    if (seen.batches[m].instance_count > 0) draw_batch(m, seen.batches[m], 1);
  }
}

void ForwardPass::draw_batch(std::size_t mesh, const Batch& batch, int copies) const {
  constexpr GLuint kInstanceBinding = 1;
  batch.used_in = frame_;
  batch.array.bind();
  if (copies > 1) glVertexArrayBindingDivisor(batch.array.id(), kInstanceBinding, static_cast<GLuint>(copies));
  glDrawElementsInstanced(GL_TRIANGLES, meshes_[mesh].index_count, GL_UNSIGNED_INT, nullptr,
                          copies * batch.instance_count);
  if (copies > 1) glVertexArrayBindingDivisor(batch.array.id(), kInstanceBinding, 1);
}

void ForwardPass::draw_all(Objects objects, int copies) const {
  auto found = everything_.find(objects);
  if (found == everything_.end()) {
    found = everything_.emplace(objects, std::vector<Batch>(meshes_.size())).first;
    for (std::size_t m = 0; m < meshes_.size(); ++m) {
      std::vector<InstanceAttributes> all;
      if (objects != Objects::optical) all = lambertian_[m];
      if (objects != Objects::lambertian) all.insert(all.end(), optical_[m].begin(), optical_[m].end());
      if (!all.empty()) found->second[m] = make_batch(m, all);
    }
  }
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    if (found->second[m].instance_count > 0) draw_batch(m, found->second[m], copies);
  }
}

void ForwardPass::bind_lights() const {
  lights_.bind_uniform(0);
  if (shadowed_) shadows_.bind();
}

void ForwardPass::draw_shaded(const Camera& camera, bool keep_depth) const {
  draw_opaque(camera, keep_depth);
  draw_background(camera);
}

void ForwardPass::draw_opaque(const Camera& camera, bool keep_depth) const {
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glEnable(GL_DEPTH_TEST);
  const glm::mat4 world_to_clip = camera.projection() * camera.world_to_view();

  if (!keep_depth) {
    glDepthMask(GL_TRUE);
    const float far_depth = 1.0F;
    glClearBufferfv(GL_DEPTH, 0, &far_depth);
  }
  glDepthMask(keep_depth ? GL_FALSE : GL_TRUE);
  glDepthFunc(GL_LEQUAL);
  bind_lights();
  opaque_.use();
  opaque_.set("world_to_clip", world_to_clip);
  opaque_.set("eye", camera.view.eye);
  draw_visible(world_to_clip, Objects::lambertian);
  glDepthMask(GL_TRUE);
}

void ForwardPass::draw_background(const Camera& camera) const {
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_FALSE);
  background_.use();
  background_.set("clip_to_world", glm::inverse(camera.projection() * camera.world_to_view()));
  background_.set("eye", camera.view.eye);
  bind_environment(background_);
  fullscreen_.bind();
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glDepthMask(GL_TRUE);
}

void ForwardPass::draw_geometry(const Camera& camera, const gl::Program& program) const {
  draw_geometry(camera.projection() * camera.world_to_view(), program);
}

void ForwardPass::draw_instance(const Scene& scene, int instance, const glm::mat4& world_to_clip,
                                const gl::Program& program) const {
  program.use();
  program.set("world_to_clip", world_to_clip);
  draw_alone(scene, instance, 1);
}

void ForwardPass::draw_alone(const Scene& scene, int instance, int copies) const {
  const Instance& object = scene.instances[static_cast<std::size_t>(instance)];
  const auto mesh = static_cast<std::size_t>(object.mesh);
  auto found = alone_.find(instance);
  if (found == alone_.end()) {
    const InstanceAttributes one = attributes(scene, object);
    found = alone_.emplace(instance, make_batch(mesh, {&one, 1})).first;
  }
  draw_batch(mesh, found->second, copies);
}

void ForwardPass::draw_geometry(const glm::mat4& world_to_clip, const gl::Program& program, Objects objects) const {
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LEQUAL);
  const float far_depth = 1.0F;
  glClearBufferfv(GL_DEPTH, 0, &far_depth);
  program.use();
  program.set("world_to_clip", world_to_clip);
  draw_visible(world_to_clip, objects);
}

void ForwardPass::draw_surface_points(const Camera& camera) {
  if (!surface_points_) {
    gl::Defines defines = light_defines_;
    defines.emplace_back("SURFACE_POINTS", "1");
    surface_points_ = gl::Program(
        "surface points", {"algorithms/shaders/opaque.vert.glsl", "algorithms/shaders/opaque.frag.glsl"}, defines);
  }
  surface_points_.set("eye", camera.view.eye);
  draw_geometry(camera, surface_points_);
}

std::string ForwardPass::reload_shaders() {
  return opaque_.reload() + background_.reload() + shadows_.reload_shaders();
}

}  // namespace pellucid
