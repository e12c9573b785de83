#include "algorithms/raster/cube_pass.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "algorithms/scene/shapes/bounds.hpp"

namespace pellucid {
namespace {

constexpr const char* kStages = "algorithms/shaders/cube.vert.glsl";
constexpr const char* kSkyStages = "algorithms/shaders/cube_sky.vert.glsl";
constexpr int kSkyVertices = 14;

int copies(CubeLayers layers) {
  return layers == CubeLayers::vertex ? gl::kCubeFaces : 1;
}

gl::Program make_program(const std::string& label, const std::string& vertex, const std::string& fragment,
                         CubeLayers layers, gl::Defines defines) {
  if (layers == CubeLayers::vertex && !vertex_shader_chooses_layers())
    throw InputError(
        "this device's vertex shaders choose no layer (GL_ARB_shader_viewport_layer_array is missing); take 'geometry' "
        "or 'faces'");
  defines.emplace_back("CUBE_PASS", fmt::to_string(static_cast<int>(layers)));
  std::vector<gl::Stage> stages{vertex};
  if (layers == CubeLayers::geometry) stages.emplace_back("algorithms/shaders/cube.geom.glsl");
  stages.push_back(fragment);
  return {label, std::move(stages), std::move(defines)};
}

}  // namespace

bool vertex_shader_chooses_layers() {
  return epoxy_has_gl_extension("GL_ARB_shader_viewport_layer_array");
}

CubeCamera CubeCamera::around(const Scene& scene, const glm::vec3& center, CubeLayers layers) {
  const Bounds bounds = world_bounds(scene);
  const glm::vec3 reach = glm::max(glm::abs(bounds.min - center), glm::abs(bounds.max - center));
  const float far_m = std::max(1.05F * glm::length(reach), 1e-2F);
  return {center, 1e-3F * far_m, far_m, layers};
}

gl::Program make_cube_program(const std::string& label, const std::string& fragment, CubeLayers layers,
                              gl::Defines defines) {
  return make_program(label, kStages, fragment, layers, std::move(defines));
}

void use_cube_program(const gl::Program& program, const CubeCamera& camera, int face) {
  static constexpr std::array<const char*, gl::kCubeFaces> kNames{"world_to_face[0]", "world_to_face[1]",
                                                                  "world_to_face[2]", "world_to_face[3]",
                                                                  "world_to_face[4]", "world_to_face[5]"};
  program.use();
  for (int i = 0; i < gl::kCubeFaces; ++i)
    program.set(kNames[static_cast<std::size_t>(i)],
                gl::cube_face_to_clip(i, camera.center, camera.near_m, camera.far_m));
  if (face >= 0) program.set("cube_face", face);
  program.set("eye", camera.center);
}

CubeTarget::CubeTarget(const std::string& label, std::initializer_list<const gl::Texture*> colors,
                       const gl::Texture* depth)
    : all_(gl::Framebuffer::layered(label, colors, depth, -1)) {
  for (int face = 0; face < gl::kCubeFaces; ++face)
    faces_.push_back(gl::Framebuffer::layered(fmt::format("{} face {}", label, face), colors, depth, face));
}

void draw_cube_objects(const ForwardPass& forward, const CubeCamera& camera, int face, const gl::Program& program,
                       Objects objects) {
  use_cube_program(program, camera, face);
  if (face >= 0)
    forward.draw_seen(gl::cube_face_to_clip(face, camera.center, camera.near_m, camera.far_m), objects);
  else
    forward.draw_all(objects, copies(camera.layers));
}

void draw_cube_object(const ForwardPass& forward, const Scene& scene, int instance, const CubeCamera& camera, int face,
                      const gl::Program& program) {
  use_cube_program(program, camera, face);
  forward.draw_alone(scene, instance, copies(camera.layers));
}

void CubeScene::draw(const ForwardPass& forward, const CubeCamera& camera, const CubeTarget& target, Distance distance,
                     float sky_distance_m) {
  gl::Defines opaque = forward.light_defines(), sky = forward.environment_defines();
  if (distance == Distance::alpha) {
    opaque.emplace_back("DISTANCE_IN_ALPHA", "1");
    sky.emplace_back("DISTANCE_IN_ALPHA", "1");
  }
  if (!opaque_ || opaque != opaque_defines_ || sky != sky_defines_ || layers_ != camera.layers) {
    opaque_ = make_cube_program("cube opaque", "algorithms/shaders/opaque.frag.glsl", camera.layers, opaque);
    sky_ = make_program("cube sky", kSkyStages, "algorithms/shaders/cube_sky.frag.glsl", camera.layers, sky);
    opaque_defines_ = std::move(opaque);
    sky_defines_ = std::move(sky);
    layers_ = camera.layers;
  }
  if (strip_.id() == 0) strip_ = gl::VertexArray("cube sky");
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  forward.bind_lights();
  target.draw(camera.layers, [&](int face) {
    glDepthMask(GL_TRUE);
    const float far_depth = 1.0F;
    glClearBufferfv(GL_DEPTH, 0, &far_depth);
    draw_cube_objects(forward, camera, face, opaque_, Objects::lambertian);
    // Last, at the far plane, so that nothing is shaded that objects hide.
    glDepthMask(GL_FALSE);
    glEnable(GL_DEPTH_CLAMP);
    use_cube_program(sky_, camera, face);
    sky_.set("sky_size", 2.0F * camera.far_m);
    sky_.set("sky_distance", sky_distance_m);
    forward.bind_environment(sky_);
    strip_.bind();
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, kSkyVertices, copies(camera.layers));
    glDisable(GL_DEPTH_CLAMP);
    glDepthMask(GL_TRUE);
  });
}

std::string CubeScene::reload_shaders() {
  return opaque_ ? opaque_.reload() + sky_.reload() : std::string();
}

}  // namespace pellucid
