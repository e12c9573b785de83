#include "algorithms/translucent_relief/relief_pass.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace pellucid::translucent_relief {
namespace {

const std::string kVertex = "algorithms/translucent_relief/relief.vert.glsl";
const std::string kFragment = "algorithms/translucent_relief/relief.frag.glsl";
constexpr GLuint kFirstCountUnit = 12;  // of bare_relief.frag.glsl

}  // namespace

void ReliefPass::prepare(const Scene& scene) {
  meshes_.clear();
  caustics_.clear();
  maps_.clear();
  maps_.resize(scene.reliefs.size());
  for (const Instance& instance : scene.instances) {
    if (instance.relief < 0 || meshes_.contains(instance.mesh)) continue;
    meshes_.try_emplace(instance.mesh, scene.meshes[static_cast<std::size_t>(instance.mesh)],
                        fmt::format("'{}' of scene '{}'", instance.name, scene.name));
  }
}

bool ReliefPass::two_layers(const Relief& relief) const {
  return relief.translucent && parameters_.translucency && parameters_.mapping == Mapping::relief;
}

gl::Defines ReliefPass::defines(const Relief& relief, const ForwardPass& forward) const {
  gl::Defines defines = forward.light_defines();
  const gl::Defines environment = forward.environment_defines();
  defines.insert(defines.end(), environment.begin(), environment.end());
  defines.emplace_back("MAPPING", parameters_.mapping == Mapping::normal ? "0" : "1");
  defines.emplace_back("SEARCH", std::to_string(static_cast<int>(parameters_.search)));
  if (two_layers(relief)) defines.emplace_back("TWO_LAYERS", "1");
  if (parameters_.boxes == Boxes::separate) defines.emplace_back("SEPARATE_BOXES", "1");
  if (parameters_.occlusion && parameters_.mapping == Mapping::relief) defines.emplace_back("OCCLUSION", "1");
  if (parameters_.absorption && two_layers(relief)) defines.emplace_back("ABSORPTION", "1");
  if (parameters_.scattering && parameters_.absorption && two_layers(relief) && relief.scatters())
    defines.emplace_back("SCATTERING", "1");
  if (objects_) defines.emplace_back("OBJECTS", "1");
  if (parameters_.caustics && two_layers(relief)) defines.emplace_back("CAUSTICS", "1");
  if (relief.air && parameters_.air_steps > 0) defines.emplace_back("AIR", "1");
  return defines;
}

void ReliefPass::update(const Scene& scene, const ForwardPass& forward) {
  program_of_.assign(scene.reliefs.size(), nullptr);
  objects_ = parameters_.object_steps > 0 && std::any_of(scene.instances.begin(), scene.instances.end(),
                                                         [&](const Instance& i) { return !optical(scene, i); });
  for (const Instance& instance : scene.instances) {
    if (instance.relief < 0) continue;
    const auto index = static_cast<std::size_t>(instance.relief);
    if (program_of_[index] != nullptr) continue;
    const bool animate = parameters_.motion == Motion::gpu && parameters_.search == Search::linear;
    maps_[index].update(scene.reliefs[index], parameters_.search, animate ? &animation_ : nullptr);
    gl::Defines wanted = defines(scene.reliefs[index], forward);
    auto found = programs_.find(wanted);
    if (found == programs_.end()) {
      gl::Program program("translucent relief", {kVertex, kFragment}, wanted);
      found = programs_.emplace(std::move(wanted), std::move(program)).first;
    }
    program_of_[index] = &found->second;
  }
  // Nothing is kept for settings of before.
  std::erase_if(programs_, [&](const auto& entry) {
    return std::find(program_of_.begin(), program_of_.end(), &entry.second) == program_of_.end();
  });
  if (!parameters_.caustics) caustics_.clear();
  if (!objects_) {
    object_color_ = {};
    object_depth_ = {};
  }
}

void ReliefPass::set_uniforms(const Scene& scene, const Instance& instance, const Camera& camera,
                              const gl::Program& program) const {
  const Relief& relief = scene.reliefs[static_cast<std::size_t>(instance.relief)];
  const ReliefMaps& maps = maps_[static_cast<std::size_t>(instance.relief)];
  maps.bind(relief, program);
  program.set("to_world", instance.to_world);
  program.set("normal_to_world", glm::transpose(glm::inverse(glm::mat3(instance.to_world))));
  program.set("world_to_clip", camera.projection() * camera.world_to_view());
  program.set("eye", camera.view.eye);
  program.set("solid_albedo", relief.solid.albedo * material_of(scene, instance).albedo * instance.tint);
  program.set("solid_phong", glm::vec2(relief.solid.specular, relief.solid.exponent));
  program.set("plane_height", maps.mean_solid_height_m(relief));
  program.set("planar_reflections", parameters_.local_rays != LocalRays::traced);
  program.set("planar_refractions", parameters_.local_rays == LocalRays::planar);
  program.set("show", static_cast<int>(parameters_.show));
  program.set("step_counts", glm::vec4(parameters_.view_steps, parameters_.reflected_steps, parameters_.refracted_steps,
                                       parameters_.light_steps));
  program.set("refinements", glm::vec4(parameters_.view_refinements, parameters_.reflected_refinements,
                                       parameters_.refracted_refinements, parameters_.light_refinements));
  program.set("steps_at_normal", parameters_.steps_at_normal);
  program.set("boundaries", parameters_.boundaries);
  program.set("air_steps", parameters_.air_steps);
  program.set("clip_planes", glm::vec2(camera.view.near_m, camera.view.far_m));
  program.set("object_steps", parameters_.object_steps);
  program.set("object_reach", parameters_.object_reach);
  if (object_color_) {
    object_color_.bind(11);
    object_depth_.bind(12);
  }
  if (!relief.translucent) return;
  program.set("medium_phong", glm::vec2(relief.translucent->specular, relief.translucent->exponent));
  program.set("intensification", relief.intensification);
  program.set("outside_index", relief.outside_index);
  program.set("index", relief.index);
  program.set("absorption", relief.absorption);
}

void ReliefPass::draw_mesh(const Scene& scene, const Instance& instance, const Camera& camera,
                           const ForwardPass& forward, const gl::Program& program) const {
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_TRUE);
  glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  glFrontFace(glm::determinant(glm::mat3(instance.to_world)) < 0 ? GL_CW : GL_CCW);
  program.use();
  forward.bind_lights();
  forward.bind_environment(program);
  set_uniforms(scene, instance, camera, program);
  meshes_.at(instance.mesh).draw();
  glFrontFace(GL_CCW);
  glDisable(GL_CULL_FACE);
}

// A frame cannot be read while it is drawn into.
void ReliefPass::copy_objects(const Target& target) {
  const auto copy = [&](const gl::Texture& from, gl::Texture& to, const char* label) {
    if (!to || to.width() != from.width() || to.height() != from.height() || to.format() != from.format()) {
      to = gl::Texture::make_2d(label, from.format(), from.width(), from.height());
      to.set_sampling(gl::Filter::nearest, gl::Wrap::clamp);
    }
    glCopyImageSubData(from.id(), GL_TEXTURE_2D, 0, 0, 0, 0, to.id(), GL_TEXTURE_2D, 0, 0, 0, 0, from.width(),
                       from.height(), 1);
  };
  copy(target.color, object_color_, "relief objects");
  copy(target.depth, object_depth_, "relief objects' depth");
}

void ReliefPass::draw(const Scene& scene, const Camera& camera, const ForwardPass& forward, const Target& target) {
  if (objects_) copy_objects(target);
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (instance.relief < 0) continue;
    if (parameters_.caustics && two_layers(scene.reliefs[static_cast<std::size_t>(instance.relief)])) {
      draw_caustics(scene, static_cast<int>(i), camera, forward);
      target.framebuffer.bind();
    }
    draw_mesh(scene, instance, camera, forward, *program_of_[static_cast<std::size_t>(instance.relief)]);
  }
}

void ReliefPass::draw_caustics(const Scene& scene, int index, const Camera& camera, const ForwardPass& forward) {
  const Instance& instance = scene.instances[static_cast<std::size_t>(index)];
  Caustics& caustics = caustics_[index];
  forward.bind_lights();
  caustics.update(scene, instance, parameters_.caustic_resolution,
                  defines(scene.reliefs[static_cast<std::size_t>(instance.relief)], forward),
                  [&](const gl::Program& program) { set_uniforms(scene, instance, camera, program); });
  caustics.bind();
}

SearchErrors ReliefPass::compare_searches(const Scene& scene, const Camera& camera, const ForwardPass& forward) const {
  const int width = camera.width, height = camera.height;
  const auto make = [&](const char* name) { return gl::Texture::make_2d(name, gl::Format::rgba32f, width, height); };
  const gl::Texture start = make("starts"), ray = make("rays"), scale = make("scales"), light = make("lights");
  const gl::Texture depth = gl::Texture::make_2d("report depth", gl::Format::depth32f, width, height);
  const gl::Framebuffer framebuffer("searches", {&start, &ray, &scale, &light}, &depth);
  const Illumination lights(scene);
  SearchErrors errors(width, height);
  for (const Instance& instance : scene.instances) {
    if (instance.relief < 0) continue;
    gl::Defines wanted = defines(scene.reliefs[static_cast<std::size_t>(instance.relief)], forward);
    wanted.emplace_back("REPORT", "1");
    const gl::Program program("relief report", {kVertex, kFragment}, wanted);
    framebuffer.bind();
    for (int attachment = 0; attachment < 4; ++attachment)
      framebuffer.clear_color(attachment, {0, 0, 0, 0});
    framebuffer.clear_depth();
    draw_mesh(scene, instance, camera, forward, program);
    errors.add({start.read(), ray.read(), scale.read(), light.read()}, ReliefTracer(scene, instance.relief, lights));
  }
  return errors;
}

ReliefPass::FetchCounts ReliefPass::count_fetches(const Scene& scene, const Camera& camera,
                                                  const ForwardPass& forward) {
  bare_ = gl::Program("bare relief", {kVertex, "algorithms/translucent_relief/bench/bare_relief.frag.glsl"},
                      forward.environment_defines());
  for (gl::Texture& counts : fetch_counts_)
    counts = gl::Texture::make_2d("fetch counts", gl::Format::rgba32f, camera.width, camera.height);
  const gl::Texture depth = gl::Texture::make_2d("count depth", gl::Format::depth32f, camera.width, camera.height);
  const gl::Framebuffer framebuffer("fetch counts", {&fetch_counts_[0], &fetch_counts_[1], &fetch_counts_[2]}, &depth);
  framebuffer.bind();
  for (int attachment = 0; attachment < 3; ++attachment)
    framebuffer.clear_color(attachment, {0, 0, 0, 0});
  framebuffer.clear_depth();
  for (const Instance& instance : scene.instances) {
    if (instance.relief < 0) continue;
    gl::Defines wanted = defines(scene.reliefs[static_cast<std::size_t>(instance.relief)], forward);
    wanted.emplace_back("COUNT", "1");
    draw_mesh(scene, instance, camera, forward, gl::Program("relief counts", {kVertex, kFragment}, wanted));
  }
  FetchCounts counts;
  std::vector<float> sums(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height), 0.0F);
  for (const gl::Texture& texture : fetch_counts_) {
    const std::vector<float> texels = texture.read();
    for (std::size_t i = 0; i < texels.size(); ++i)
      sums[i / 4] += texels[i];
  }
  for (const float sum : sums) {
    counts.pixels += sum > 0 ? 1 : 0;
    counts.fetches += static_cast<double>(sum);
  }
  return counts;
}

void ReliefPass::draw_bare(const Scene& scene, const Camera& camera, const ForwardPass& forward) const {
  for (std::size_t i = 0; i < fetch_counts_.size(); ++i)
    fetch_counts_[i].bind(kFirstCountUnit + static_cast<GLuint>(i));
  for (const Instance& instance : scene.instances) {
    if (instance.relief >= 0) draw_mesh(scene, instance, camera, forward, bare_);
  }
}

std::string ReliefPass::reload_shaders() {
  std::string words = animation_.reload_shaders();
  for (auto& [instance, caustics] : caustics_)
    words += caustics.reload_shaders();
  for (auto& [defines, program] : programs_)
    words += program.reload();
  return words;
}

}  // namespace pellucid::translucent_relief
