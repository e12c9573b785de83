#include "algorithms/translucent_relief/caustics.hpp"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "algorithms/scene/meshes/tangents.hpp"
#include "gl/error.hpp"

namespace pellucid::translucent_relief {
namespace {

// The frame that all points of a flat mesh share.
SurfaceFrame<glm::vec3> frame_of(const Scene& scene, const Instance& instance) {
  const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
  const std::string what = fmt::format("'{}' of scene '{}'", instance.name, scene.name);
  const Tangents tangents = tangents_of(mesh, what);
  const glm::vec3& normal = mesh.normals.front();
  if (std::any_of(mesh.normals.begin(), mesh.normals.end(),
                  [&](const glm::vec3& n) { return glm::distance(n, normal) > 1e-3F; })) {
    throw InputError(fmt::format("translucent_relief: caustics = true takes flat meshes, and {} is not flat", what));
  }
  const glm::mat3 to_world(instance.to_world);
  return surface_frame(glm::normalize(glm::transpose(glm::inverse(to_world)) * normal), to_world * tangents.u.front(),
                       to_world * tangents.v.front());
}

}  // namespace

void Caustics::update(const Scene& scene, const Instance& instance, int resolution, const gl::Defines& defines,
                      const std::function<void(const gl::Program&)>& set_uniforms) {
  const SurfaceFrame<glm::vec3> frame = frame_of(scene, instance);
  if (!program_ || defines != defines_) {
    const std::string folder = "algorithms/translucent_relief/";
    program_ = gl::Program("caustics", {folder + "caustics.vert.glsl", folder + "caustics.frag.glsl"}, defines);
    defines_ = defines;
    grid_ = gl::VertexArray("caustics");
  }
  if (!maps_ || maps_.width() != resolution) {
    maps_ = gl::Texture::make_2d_array("caustics", gl::Format::rgba16f, resolution, resolution, kMaxLights);
    maps_.set_sampling(gl::Filter::linear, gl::Wrap::repeat);
  }
  program_.use();
  set_uniforms(program_);
  program_.set("cut", false);
  const bool copies = !scene.reliefs[static_cast<std::size_t>(instance.relief)].cut;
  const int grid = std::max(1, resolution / 2);
  program_.set("copies", copies);
  program_.set("grid", grid);
  program_.set("resolution", static_cast<float>(resolution));
  program_.set("metres", glm::vec2(frame.metres_per_u, frame.metres_per_v));
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    const glm::vec3 to_light(-glm::dot(light.direction, frame.along_u), -glm::dot(light.direction, frame.along_v),
                             -glm::dot(light.direction, frame.normal));
    if (light.kind != LightKind::directional || to_light.z <= 0.0F) continue;
    const gl::Framebuffer target = gl::Framebuffer::layered("caustics", maps_, nullptr, static_cast<int>(i));
    target.bind();
    target.clear_color(0, {0, 0, 0, 0});
    program_.set("to_light", to_light);
    grid_.bind();
    glDrawArraysInstanced(GL_TRIANGLES, 0, 6 * grid * grid, copies ? 9 : 1);
  }
  glDisable(GL_BLEND);
}

}  // namespace pellucid::translucent_relief
