// Chan and Wang 2005 (references.bib: chan2005), Sec. 2: the transparency shader.
#include "algorithms/geocube/geocube.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "algorithms/forward_pass.hpp"
#include "algorithms/geocube/glass_object.hpp"
#include "algorithms/geocube/native_errors.hpp"
#include "gl/program.hpp"

namespace pellucid::geocube {
namespace {

class Geocube final : public Technique {
 public:
  ParameterRef parameters() override { return bind_parameters(parameters_); }

  void prepare(const Scene& scene) override {
    objects_.clear();
    frame_.reset();
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
      if (optical(scene, scene.instances[i])) objects_.emplace_back(scene, static_cast<int>(i), parameters_);
    }
    function_table_ = make_function_table(parameters_.table_size);
  }

  void render(const Scene& scene, const Camera& camera, ForwardPass& forward, const Target& target,
              gl::PassTimer& timer) override {
    refresh(scene);
    compile(forward.environment_defines());
    {
      auto pass = timer.pass("opaque");
      target.framebuffer.bind();
      forward.draw_shaded(camera, false);
    }
    forward.bind_environment(glass_);
    forward.bind_environment(reflect_);
    auto pass = timer.pass("glass");
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    glDepthMask(GL_TRUE);
    for (const GlassObject& object : objects_)
      draw(object, scene, camera, object.cubes() != nullptr ? glass_ : reflect_);
    frame_ = Frame{&scene, &forward, camera};
  }

  void native_errors(nlohmann::json& out) const override {
    double built_s = 0, unseen = 0, dropped = 0;
    std::size_t cubes = 0, bytes = 0;
    for (const GlassObject& object : objects_) {
      if (object.cubes() == nullptr) continue;
      const CubeSet& set = object.cubes()->set();
      built_s += set.build_s;
      cubes += set.cubes.size();
      bytes += texture_bytes(set.options, set.cubes.size());
      unseen = std::max(unseen, set.unseen_share);
      for (const Cube& cube : set.cubes)
        dropped = std::max(dropped, cube.dropped_share);
    }
    if (cubes == 0) return;
    out["precomputation_s"] = built_s;  // of the run that filled the cache, if it was cached
    out["cubes_placed"] = cubes;
    out["cube_bytes"] = bytes;
    out["unseen_share"] = unseen;
    out["dropped_share"] = dropped;
    if (frame_) compare_searches(out);
  }

  std::string reload_shaders() override {
    std::string words;
    for (gl::Program* program : {&glass_, &reflect_}) {
      if (*program) words += program->reload();
    }
    return words;
  }

 private:
  struct Frame {
    const Scene* scene;
    const ForwardPass* forward;
    Camera camera;
  };

  // A material or a scale may have changed without a call of prepare().
  void refresh(const Scene& scene) {
    for (GlassObject& object : objects_) {
      if (!object.fits(scene)) object = GlassObject(scene, object.instance(), parameters_);
    }
  }

  gl::Defines own_defines() const {
    gl::Defines defines;
    if (parameters_.functions == Functions::table) defines.emplace_back("FUNCTION_TABLE", "1");
    if (parameters_.stage == SearchStage::split) defines.emplace_back("SPLIT", "1");
    if (parameters_.layers > 1) defines.emplace_back("LAYERS", "1");
    return defines;
  }

  void compile(const gl::Defines& environment) {
    gl::Defines defines = own_defines();
    defines.insert(defines.end(), environment.begin(), environment.end());
    if (glass_ && defines == defines_) return;
    const std::string folder = "algorithms/geocube/";
    glass_ = gl::Program("geocube", {folder + "object.vert.glsl", folder + "glass.frag.glsl"}, defines);
    reflect_ = gl::Program("geocube mirrors", {folder + "object.vert.glsl", folder + "reflect.frag.glsl"}, environment);
    defines_ = std::move(defines);
  }

  void draw(const GlassObject& object, const Scene& scene, const Camera& camera, const gl::Program& program) const {
    const Material& material =
        scene
            .materials[static_cast<std::size_t>(scene.instances[static_cast<std::size_t>(object.instance())].material)];
    const glm::mat4 to_world = object.to_world(scene);
    const glm::mat3 linear(to_world);
    const float determinant = glm::determinant(linear);
    program.use();
    program.set("object_to_clip", camera.projection() * camera.world_to_view() * to_world);
    program.set("eye", glm::vec3(glm::inverse(to_world) * glm::vec4(camera.view.eye, 1.0F)));
    program.set("object_to_world", linear);
    program.set("reflectance", material.reflectance);
    program.set("metal", material.kind == SurfaceKind::metal);
    program.set("metal_n", material.metal_n);
    program.set("metal_k", material.metal_k);
    if (object.cubes() != nullptr) {
      const CubeSet& set = object.cubes()->set();
      const auto diagonal = static_cast<float>(set.diagonal);
      const float sine_c = std::min(1.0F, 1.0F / material.ior);
      object.cubes()->bind(program);
      function_table_.bind(3);
      program.set("object_scale", std::cbrt(std::abs(determinant)));
      program.set("ior", material.ior);
      program.set("relative_index", 1.0F / material.ior);
      program.set("absorption", material.absorption);
      program.set("diagonal", diagonal);
      program.set("min_step", parameters_.min_step * diagonal);
      program.set("cosine_c", std::sqrt(1.0F - sine_c * sine_c));
      program.set("iterations", parameters_.iterations);
      program.set("vertex_iterations", parameters_.vertex_iterations);
      program.set("refine", parameters_.refine);
      program.set("switches", parameters_.switches);
      program.set("reflections", parameters_.reflections);
      program.set("show", static_cast<int>(parameters_.show));
    }
    glEnable(GL_CULL_FACE);
    glCullFace(GL_BACK);
    glFrontFace(determinant < 0 ? GL_CW : GL_CCW);
    object.draw();
    glFrontFace(GL_CCW);
    glDisable(GL_CULL_FACE);
  }

  // The first searches of the last frame's pixels, drawn again into textures.
  void compare_searches(nlohmann::json& out) const {
    const Scene& scene = *frame_->scene;
    const int width = frame_->camera.width, height = frame_->camera.height;
    const auto make = [&](const char* name) { return gl::Texture::make_2d(name, gl::Format::rgba32f, width, height); };
    const gl::Texture entry = make("entries"), ray = make("rays"), point = make("exits"), normal = make("exit normals");
    const gl::Texture depth = gl::Texture::make_2d("search depth", gl::Format::depth32f, width, height);
    const gl::Framebuffer framebuffer("searches", {&entry, &ray, &point, &normal}, &depth);
    gl::Defines defines = own_defines();
    defines.emplace_back("REPORT", "1");
    const std::string folder = "algorithms/geocube/";
    const gl::Program program("geocube report", {folder + "object.vert.glsl", folder + "glass.frag.glsl"}, defines);
    SearchErrors errors;
    for (const GlassObject& object : objects_) {
      if (object.cubes() == nullptr) continue;
      framebuffer.bind();
      for (int i = 0; i < 4; ++i)
        framebuffer.clear_color(i, {0, 0, 0, 0});
      framebuffer.clear_depth();
      glEnable(GL_DEPTH_TEST);
      glDepthFunc(GL_LEQUAL);
      draw(object, scene, frame_->camera, program);
      const Material& material = scene.materials[static_cast<std::size_t>(
          scene.instances[static_cast<std::size_t>(object.instance())].material)];
      errors.add({entry.read(), ray.read(), point.read(), normal.read()}, *object.solid(),
                 static_cast<double>(material.ior));
    }
    errors.write(out);
  }

  Parameters parameters_;
  std::vector<GlassObject> objects_;
  gl::Texture function_table_;
  gl::Program glass_, reflect_;
  gl::Defines defines_;
  std::optional<Frame> frame_;
};

}  // namespace

const ParameterTable& table() {
  return parameter_table<Parameters>();
}
std::unique_ptr<Technique> make() {
  return std::make_unique<Geocube>();
}

}  // namespace pellucid::geocube
