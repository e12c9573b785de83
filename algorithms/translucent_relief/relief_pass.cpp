#include "algorithms/translucent_relief/relief_pass.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace pellucid::translucent_relief {
namespace {

const std::string kVertex = "algorithms/translucent_relief/relief.vert.glsl";
const std::string kFragment = "algorithms/translucent_relief/relief.frag.glsl";
const std::string kBare = "algorithms/translucent_relief/bench/bare_relief.frag.glsl";
constexpr GLuint kRecordsImage = 0, kRecordsUnit = 14;

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
  defines.emplace_back("SHOW", std::to_string(static_cast<int>(parameters_.show)));
  const auto flag = [](bool value) { return value ? "true" : "false"; };
  defines.emplace_back("PLANAR_REFLECTIONS", flag(parameters_.local_rays != LocalRays::traced));
  defines.emplace_back("PLANAR_REFRACTIONS", flag(parameters_.local_rays == LocalRays::planar));
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
  // From where on Phong's term is 1e-4, which no picture shows.
  const double weight = static_cast<double>(relief.translucent->specular);
  program.set("least_shine",
              weight < 1e-4
                  ? 2.0F
                  : static_cast<float>(std::pow(1e-4 / weight, 1 / static_cast<double>(relief.translucent->exponent))));
  program.set("intensification", relief.intensification);
  program.set("index_ratios", glm::vec2(relief.outside_index / relief.index, relief.index / relief.outside_index));
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
  // As bench/recorded_searches.glsl lays them out.
  const int lights = static_cast<int>(scene.lights.size());
  const int groups = 2 + 3 * lights * ((4 + parameters_.boundaries) / 4);
  const auto make_records = [&](gl::Format format, int layers) {
    return gl::Texture::make_2d_array("searches", format, camera.width, camera.height, layers);
  };
  gl::Texture words = make_records(gl::Format::r32ui, 4 * groups);
  words.clear({0, 0, 0, 0});
  const gl::Texture counts = gl::Texture::make_2d("fetch counts", gl::Format::r32f, camera.width, camera.height);
  const gl::Texture depth = gl::Texture::make_2d("count depth", gl::Format::depth32f, camera.width, camera.height);
  const gl::Framebuffer framebuffer("fetch counts", {&counts}, &depth);
  framebuffer.bind();
  framebuffer.clear_color(0, {0, 0, 0, 0});
  framebuffer.clear_depth();
  bare_.clear();
  bare_.resize(scene.reliefs.size());
  for (const Instance& instance : scene.instances) {
    if (instance.relief < 0) continue;
    gl::Defines wanted = defines(scene.reliefs[static_cast<std::size_t>(instance.relief)], forward);
    bare_[static_cast<std::size_t>(instance.relief)] = gl::Program("bare relief", {kVertex, kBare}, wanted);
    wanted.emplace_back("COUNT", "1");
    const gl::Program program("relief counts", {kVertex, kFragment}, wanted);
    words.bind_image(kRecordsImage, GL_WRITE_ONLY);
    draw_mesh(scene, instance, camera, forward, program);
  }
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
  records_ = make_records(gl::Format::rgba32f, groups);
  const std::vector<float> layers = words.read();
  const std::size_t pixels = layers.size() / static_cast<std::size_t>(4 * groups);
  std::vector<float> group(4 * pixels);
  for (int layer = 0; layer < groups; ++layer) {
    for (std::size_t i = 0; i < group.size(); ++i)
      group[i] = layers[(4 * static_cast<std::size_t>(layer) + i % 4) * pixels + i / 4];
    records_.upload_layer(layer, group);
  }
  FetchCounts sums;
  for (const float count : counts.read()) {
    sums.pixels += count > 0 ? 1 : 0;
    sums.fetches += static_cast<double>(count);
  }
  return sums;
}

void ReliefPass::draw_bare(const Scene& scene, const Camera& camera, const ForwardPass& forward) const {
  records_.bind(kRecordsUnit);
  for (const Instance& instance : scene.instances) {
    if (instance.relief >= 0)
      draw_mesh(scene, instance, camera, forward, bare_[static_cast<std::size_t>(instance.relief)]);
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
