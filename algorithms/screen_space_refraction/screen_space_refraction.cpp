// Two-interface refraction in the space of the screen (references.bib: wyman2005).
#include "algorithms/screen_space_refraction/screen_space_refraction.hpp"

#include <cassert>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "algorithms/raster/environment_alone.hpp"
#include "algorithms/raster/forward_pass.hpp"
#include "algorithms/raster/mirror.hpp"
#include "algorithms/reference/geometry.hpp"
#include "algorithms/scene/shapes/bounds.hpp"
#include "gl/program.hpp"

namespace pellucid::screen_space_refraction {
namespace {

struct Vertex {
  glm::vec3 position, normal;
  float normal_depth;
};

// d_N of Sec. 3.1: from each vertex along the inward normal to the next surface; 0 where there is none.
std::vector<Vertex> with_normal_depth(const Mesh& mesh) {
  Scene solid;
  solid.meshes.push_back(mesh);
  solid.materials.emplace_back();
  solid.instances.push_back({.name = mesh.name});
  const Geometry geometry(solid);
  // The ray sets out from the surface it must not find again.
  const Bounds bounds = mesh_bounds(mesh);
  const double clearance = 1e-5 * static_cast<double>(glm::length(bounds.max - bounds.min));
  std::vector<Vertex> vertices(mesh.positions.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Hit hit = geometry.intersect(glm::dvec3(mesh.positions[i]), -glm::dvec3(mesh.normals[i]), clearance,
                                       std::numeric_limits<double>::infinity());
    vertices[i] = {mesh.positions[i], mesh.normals[i],
                   hit.instance != nullptr ? static_cast<float>(hit.distance) : 0.0F};
  }
  return vertices;
}

class ScreenSpaceRefraction final : public Technique {
 public:
  ParameterRef parameters() override { return bind_parameters(parameters_); }

  void prepare(const Scene& scene) override {
    warn_of_black_environment(scene, "screen_space_refraction");
    objects_.clear();
    objects_.resize(scene.meshes.size());
    for (const Instance& instance : scene.instances) {
      Object& object = objects_[static_cast<std::size_t>(instance.mesh)];
      if (!optical(scene, instance) || object.index_count > 0) continue;
      const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
      object.vertices = gl::Buffer(mesh.name, std::span<const Vertex>(with_normal_depth(mesh)));
      object.indices = gl::Buffer(mesh.name + " indices", std::span<const glm::uvec3>(mesh.triangles));
      object.array = gl::VertexArray(mesh.name, object.vertices, sizeof(Vertex),
                                     {{0, 3, offsetof(Vertex, position)},
                                      {1, 3, offsetof(Vertex, normal)},
                                      {2, 1, offsetof(Vertex, normal_depth)}},
                                     &object.indices);
      object.index_count = static_cast<int>(mesh.triangles.size() * 3);
    }
  }

  void render(const Scene& scene, const Camera& camera, ForwardPass& forward, const Target& target,
              gl::PassTimer& timer) override {
    fit(target);
    compile(forward.environment_defines());
    const glm::mat4 world_to_clip = camera.projection() * camera.world_to_view();
    for (const gl::Program* program : {&back_, &refract_, &reflect_}) {
      program->set("eye", camera.view.eye);
      program->set("world_to_clip", world_to_clip);
    }
    forward.bind_environment(refract_);
    forward.bind_environment(reflect_);
    {
      auto pass = timer.pass("opaque");
      target.framebuffer.bind();
      forward.draw_shaded(camera, false);
    }
    for (const Instance& instance : scene.instances) {
      const Material& material = material_of(scene, instance);
      if (material.kind == SurfaceKind::dielectric) {
        draw_far_side(instance, timer);
        draw_refraction(instance, material, target, timer);
      } else if (material.optical()) {
        auto pass = timer.pass("reflect");
        set_mirror(reflect_, material);
        target.framebuffer.bind();
        glEnable(GL_DEPTH_TEST);
        glDepthFunc(GL_LEQUAL);
        draw(instance, reflect_);
      }
    }
  }

  std::string reload_shaders() override {
    std::string words;
    for (gl::Program* program : {&back_, &refract_, &reflect_}) {
      if (*program) words += program->reload();
    }
    return words;
  }

 private:
  struct Object {
    gl::Buffer vertices, indices;
    gl::VertexArray array;
    int index_count = 0;
  };

  void draw(const Instance& instance, const gl::Program& program) const {
    const Object& object = objects_[static_cast<std::size_t>(instance.mesh)];
    assert(object.index_count > 0);
    program.use();
    program.set("to_world", instance.to_world);
    program.set("normal_to_world", glm::transpose(glm::inverse(glm::mat3(instance.to_world))));
    object.array.bind();
    glDrawElements(GL_TRIANGLES, object.index_count, GL_UNSIGNED_INT, nullptr);
  }

  // The first pass of Sec. 3.2: normals and distances of what faces away.
  void draw_far_side(const Instance& instance, gl::PassTimer& timer) {
    auto pass = timer.pass("far side");
    const bool farthest = parameters_.far_side == FarSide::farthest;
    far_framebuffer_.bind();
    far_framebuffer_.clear_color(0, {0, 0, 0, 0});
    glDepthMask(GL_TRUE);
    far_framebuffer_.clear_depth(farthest ? 0.0F : 1.0F);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(farthest ? GL_GEQUAL : GL_LEQUAL);
    glEnable(GL_CULL_FACE);
    glCullFace(GL_FRONT);
    draw(instance, back_);
    glDisable(GL_CULL_FACE);
    glDepthFunc(GL_LEQUAL);
  }

  void draw_refraction(const Instance& instance, const Material& material, const Target& target, gl::PassTimer& timer) {
    auto pass = timer.pass("refract");
    target.framebuffer.bind();
    refract_.set("ior", material.ior);
    refract_.set("absorption", material.absorption);
    far_side_.bind(1);
    glEnable(GL_CULL_FACE);
    glCullFace(GL_BACK);
    draw(instance, refract_);
    glDisable(GL_CULL_FACE);
  }

  void fit(const Target& target) {
    const int width = target.color.width(), height = target.color.height();
    if (far_side_ && far_side_.width() == width && far_side_.height() == height) return;
    far_side_ = gl::Texture::make_2d("far side", gl::Format::rgba32f, width, height);
    // Between a normal and the background around it there is no mean.
    far_side_.set_sampling(gl::Filter::nearest, gl::Wrap::border);
    far_depth_ = gl::Texture::make_2d("far side depth", gl::Format::depth32f, width, height);
    far_framebuffer_ = gl::Framebuffer("far side", {&far_side_}, &far_depth_);
  }

  void compile(gl::Defines defines) {
    const gl::Defines environment = defines;
    if (parameters_.normal_depth) defines.emplace_back("NORMAL_DEPTH", "1");
    if (parameters_.total_reflection == TotalReflection::reflect) defines.emplace_back("REFLECT", "1");
    if (refract_ && defines == defines_) return;
    const std::string folder = "algorithms/screen_space_refraction/";
    const std::string object = folder + "object.vert.glsl";
    back_ = gl::Program("far side", {object, folder + "back.frag.glsl"});
    refract_ = gl::Program("refract", {object, folder + "refract.frag.glsl"}, defines);
    reflect_ = gl::Program("reflect", {object, folder + "reflect.frag.glsl"}, environment);
    defines_ = std::move(defines);
  }

  Parameters parameters_;
  std::vector<Object> objects_;  // by mesh; empty where no optical instance uses it
  gl::Texture far_side_, far_depth_;
  gl::Framebuffer far_framebuffer_;
  gl::Program back_, refract_, reflect_;
  gl::Defines defines_;
};

}  // namespace

const ParameterTable& table() {
  return parameter_table<Parameters>();
}
std::unique_ptr<Technique> make() {
  return std::make_unique<ScreenSpaceRefraction>();
}

}  // namespace pellucid::screen_space_refraction
