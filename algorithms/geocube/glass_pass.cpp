#include "algorithms/geocube/glass_pass.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "algorithms/raster/mirror.hpp"
#include "algorithms/raster/pixel_area.hpp"
#include "gl/error.hpp"

namespace pellucid::geocube {
namespace {

const std::string kFullscreen = "algorithms/shaders/fullscreen.vert.glsl";
const std::string kGlass = "algorithms/geocube/glass.frag.glsl";

}  // namespace

void GlassPass::prepare(const Scene& scene) {
  objects_.clear();
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    if (optical(scene, scene.instances[i])) objects_.emplace_back(scene, static_cast<int>(i), parameters_);
  }
  const scattering::KeyChainOptions chain{.face_size = parameters_.face_size,
                                          .omega = static_cast<double>(parameters_.omega),
                                          .filter = parameters_.key_filter};
  if (const auto settings = translucency_settings(parameters_.transfer, chain, parameters_.widening))
    translucency_.prepare(scene, *settings);
  function_table_ = make_function_table(parameters_.table_size);
  fullscreen_ = gl::VertexArray("geocube fullscreen");
}

void GlassPass::draw_entries(const Scene& scene, const Camera& camera, ForwardPass& forward, const Target& target,
                             gl::PassTimer& timer) {
  refresh(scene);
  const auto settings = translucency_settings(parameters_.transfer);
  compile(forward.environment_defines(), settings ? Translucency::defines(scene, settings->model) : gl::Defines{});
  {
    auto pass = timer.pass("opaque");
    target.framebuffer.bind();
    forward.draw_opaque(camera, false);
  }
  forward.bind_environment(glass_);
  forward.bind_environment(reflect_);
  {
    auto pass = timer.pass("mirrors");
    draw_mirrors(scene, camera);
  }
  fit(target.color.width(), target.color.height());
  {
    auto pass = timer.pass("entries");
    const gl::Framebuffer entries = entry_framebuffer(target.depth);
    entries.bind();
    entries.clear_color(0, {0, 0, 0, 0});
    for (const GlassObject& object : objects_) {
      if (object.cubes() == nullptr) continue;
      set_search(object, material_of(scene, object.instance()), entry_);
      draw_object(object, scene, camera, entry_);
    }
  }
  auto pass = timer.pass("background");
  target.framebuffer.bind();
  forward.draw_background(camera);
}

void GlassPass::draw_glass(const Scene& scene, const Camera& camera, const Target& target) const {
  target.framebuffer.bind();
  draw_pixels(scene, camera, glass_, nullptr);
}

std::string GlassPass::reload_shaders() {
  std::string words;
  for (gl::Program* program : {&entry_, &glass_, &reflect_}) {
    if (*program) words += program->reload();
  }
  return words;
}

FetchCounts GlassPass::count_fetches(const Scene& scene, const Camera& camera, const ForwardPass& forward) {
  if (parameters_.functions != Functions::evaluated || parameters_.stage != SearchStage::fragment ||
      parameters_.layers > 1)
    throw InputError("bench: the bare shader of geocube is of functions = evaluated, stage = fragment and layers = 1");
  if (parameters_.transfer != Transfer::none && scatters(scene))
    throw InputError(
        "bench: the bare shader of geocube does not count what a scattering medium fetches: transfer = none");
  gl::Defines defines = defines_;
  bare_ = gl::Program("bare glass", {kFullscreen, "algorithms/geocube/bench/bare_glass.frag.glsl"}, defines);
  defines.emplace_back("COUNT", "1");
  const gl::Program count("geocube counts", {kFullscreen, kGlass}, defines);
  forward.bind_environment(count);
  fetch_counts_ = gl::Texture::make_2d("fetch counts", gl::Format::rgba32f, entries_.width(), entries_.height());
  const gl::Framebuffer framebuffer("fetch counts", {&fetch_counts_});
  framebuffer.bind();
  framebuffer.clear_color(0, {0, 0, 0, 0});
  draw_pixels(scene, camera, count, nullptr);
  FetchCounts counts;
  const std::vector<float> texels = fetch_counts_.read();
  for (std::size_t i = 0; i < texels.size(); i += 4) {
    counts.pixels += static_cast<double>(texels[i + 3]);
    counts.fetches += static_cast<double>(2 * texels[i] + texels[i + 1] + texels[i + 2]);
  }
  return counts;
}

void GlassPass::draw_bare(const Scene& scene, const Camera& camera, const Target& target) const {
  target.framebuffer.bind();
  fetch_counts_.bind(7);
  draw_pixels(scene, camera, bare_, nullptr);
}

// A material or a scale may have changed without a call of prepare().
void GlassPass::refresh(const Scene& scene) {
  for (GlassObject& object : objects_) {
    if (!object.fits(scene, parameters_)) object = GlassObject(scene, object.instance(), parameters_);
  }
}

gl::Defines GlassPass::own_defines() const {
  gl::Defines defines;
  if (parameters_.functions == Functions::table) defines.emplace_back("FUNCTION_TABLE", "1");
  if (parameters_.stage == SearchStage::split) defines.emplace_back("SPLIT", "1");
  if (parameters_.layers > 1) defines.emplace_back("LAYERS", "1");
  std::size_t most = 1;  // what only a choice among many cubes takes is left out of the program
  for (const GlassObject& object : objects_) {
    if (object.cubes() != nullptr) most = std::max(most, object.cubes()->set().cubes.size());
  }
  defines.emplace_back("CUBES", most > 2 ? "3" : most == 2 ? "2" : "1");
  return defines;
}

void GlassPass::compile(const gl::Defines& environment, const gl::Defines& medium) {
  if (parameters_.stage == SearchStage::split && parameters_.layers > 1)
    throw InputError("geocube: stage = split takes layers = 1");
  gl::Defines defines = own_defines();
  defines.insert(defines.end(), environment.begin(), environment.end());
  defines.insert(defines.end(), medium.begin(), medium.end());
  if (glass_ && defines == defines_) return;
  const std::string folder = "algorithms/geocube/";
  entry_ = gl::Program("geocube entries", {folder + "object.vert.glsl", folder + "entry.frag.glsl"}, defines);
  glass_ = gl::Program("geocube", {kFullscreen, kGlass}, defines);
  reflect_ = gl::Program("geocube mirrors", {folder + "object.vert.glsl", folder + "reflect.frag.glsl"}, environment);
  defines_ = std::move(defines);
}

void GlassPass::fit(int width, int height) {
  if (entries_ && entries_.width() == width && entries_.height() == height) return;
  entries_ = gl::Texture::make_2d("entries", gl::Format::rgba32f, width, height);
  entry_cleared_ = gl::Texture::make_2d("cleared ways", gl::Format::r32f, width, height);
}

gl::Framebuffer GlassPass::entry_framebuffer(const gl::Texture& depth) const {
  if (parameters_.stage == SearchStage::split) return gl::Framebuffer("entries", {&entries_, &entry_cleared_}, &depth);
  return gl::Framebuffer("entries", {&entries_}, &depth);
}

// The facts about an object and the parameters that the search needs.
void GlassPass::set_search(const GlassObject& object, const Material& material, const gl::Program& program) const {
  const auto diagonal = static_cast<float>(object.cubes()->set().diagonal);
  const float sine_c = std::min(1.0F, 1.0F / material.ior);
  object.cubes()->bind(program);
  function_table_.bind(3);
  program.set("relative_index", 1.0F / material.ior);
  program.set("min_step", parameters_.min_step * diagonal);
  program.set("cosine_c", std::sqrt(1.0F - sine_c * sine_c));
  program.set("iterations", parameters_.iterations);
  program.set("vertex_iterations", parameters_.vertex_iterations);
  program.set("refine", parameters_.refine);
  program.set("switches", parameters_.switches);
  program.set("ask_always", parameters_.ask == Ask::always);
  program.set("object_number", object.instance() + 1);
}

void GlassPass::draw_object(const GlassObject& object, const Scene& scene, const Camera& camera,
                            const gl::Program& program) const {
  const glm::mat4 to_world = object.to_world(scene);
  program.use();
  program.set("object_to_clip", camera.projection() * camera.world_to_view() * to_world);
  program.set("eye", glm::vec3(glm::inverse(to_world) * glm::vec4(camera.view.eye, 1.0F)));
  program.set("object_to_world", glm::mat3(to_world));
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_TRUE);
  glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  glFrontFace(glm::determinant(glm::mat3(to_world)) < 0 ? GL_CW : GL_CCW);
  object.draw();
  glFrontFace(GL_CCW);
  glDisable(GL_CULL_FACE);
}

void GlassPass::draw_mirrors(const Scene& scene, const Camera& camera) const {
  for (const GlassObject& object : objects_) {
    if (object.cubes() != nullptr) continue;
    set_mirror(reflect_, material_of(scene, object.instance()));
    draw_object(object, scene, camera, reflect_);
  }
}

// The pixels of the bound framebuffer that show a dielectric; `only` one of them, or all.
void GlassPass::draw_pixels(const Scene& scene, const Camera& camera, const gl::Program& program,
                            const GlassObject* only) const {
  entries_.bind(5);
  entry_cleared_.bind(6);
  program.use();
  for (const GlassObject& object : objects_) {
    if (object.cubes() == nullptr || (only != nullptr && only != &object)) continue;
    const Material& material = material_of(scene, object.instance());
    const glm::mat4 to_world = object.to_world(scene);
    const Bounds box{glm::vec3(object.solid()->low()), glm::vec3(object.solid()->high())};
    const auto area =
        seen_area(camera.projection() * camera.world_to_view() * to_world, box, entries_.width(), entries_.height());
    if (!area) continue;
    set_search(object, material, program);
    program.set("eye", glm::vec3(glm::inverse(to_world) * glm::vec4(camera.view.eye, 1.0F)));
    program.set("pixel_to_ray", pixel_to_ray(camera, to_world));
    program.set("object_to_world", glm::mat3(to_world));
    program.set("object_scale", std::cbrt(std::abs(glm::determinant(glm::mat3(to_world)))));
    program.set("ior", material.ior);
    program.set("absorption", material.absorption);
    if (parameters_.transfer != Transfer::none) translucency_.bind(program, scene, material);
    program.set("diagonal", static_cast<float>(object.cubes()->set().diagonal));
    program.set("reflections", parameters_.reflections);
    program.set("cut", parameters_.cut);
    program.set("show", static_cast<int>(parameters_.show));
    fill_area(*area, fullscreen_);
  }
}

// From a pixel's (x, y, 1) to where its ray, from the eye, has gone one metre along the view's axis; object's space.
glm::mat3 GlassPass::pixel_to_ray(const Camera& camera, const glm::mat4& to_world) const {
  const glm::mat4 projection = camera.projection();
  const glm::vec2 corner(1.0F / projection[0][0], 1.0F / projection[1][1]);
  const glm::vec2 pixel = 2.0F * corner / glm::vec2(entries_.width(), entries_.height());
  const glm::mat3 pixel_to_view(glm::vec3(pixel.x, 0, 0), glm::vec3(0, pixel.y, 0), glm::vec3(-corner, -1.0F));
  return glm::mat3(glm::inverse(camera.world_to_view() * to_world)) * pixel_to_view;
}

SearchErrors GlassPass::compare_searches(const Scene& scene, const Camera& camera) const {
  const int width = entries_.width(), height = entries_.height();
  const auto make = [&](const char* name) { return gl::Texture::make_2d(name, gl::Format::rgba32f, width, height); };
  const gl::Texture entry = make("entries"), ray = make("rays"), point = make("exits"), normal = make("exit normals");
  const gl::Framebuffer framebuffer("searches", {&entry, &ray, &point, &normal});
  gl::Defines defines = own_defines();
  defines.emplace_back("REPORT", "1");
  const gl::Program program("geocube report", {kFullscreen, kGlass}, defines);
  SearchErrors errors(width, height);
  for (const GlassObject& object : objects_) {
    if (object.cubes() == nullptr) continue;
    framebuffer.bind();
    framebuffer.clear_color(0, {0, 0, 0, 0});
    draw_pixels(scene, camera, program, &object);
    errors.add({entry.read(), ray.read(), point.read(), normal.read()}, *object.solid(),
               static_cast<double>(material_of(scene, object.instance()).ior));
  }
  return errors;
}

}  // namespace pellucid::geocube
