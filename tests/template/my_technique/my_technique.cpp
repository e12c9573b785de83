// A tint over the opaque picture; the template of a technique.
#include "algorithms/my_technique/my_technique.hpp"

#include <string>

#include "algorithms/raster/forward_pass.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace pellucid::my_technique {
namespace {

class MyTechnique final : public Technique {
 public:
  ParameterRef parameters() override { return bind_parameters(parameters_); }

  void prepare(const Scene&) override {}  // precomputation, which is timed apart

  void render(const Scene&, const Camera& camera, ForwardPass& forward, const Target& target,
              gl::PassTimer& timer) override {
    compile();
    {
      const auto pass = timer.pass("opaque");
      target.framebuffer.bind();
      forward.draw_shaded(camera, false);
    }
    const auto pass = timer.pass("tint");
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    program_.set("strength", parameters_.strength);
    program_.use();
    fullscreen_.bind();
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDisable(GL_BLEND);
  }

  std::string reload_shaders() override { return program_ ? program_.reload() : std::string(); }

 private:
  void compile() {
    gl::Defines defines;
    if (parameters_.inverted) defines.emplace_back("INVERTED", "1");
    if (program_ && defines == defines_) return;
    program_ = gl::Program(
        "tint", {"algorithms/shaders/fullscreen.vert.glsl", "algorithms/my_technique/tint.frag.glsl"}, defines);
    defines_ = defines;
  }

  Parameters parameters_;
  gl::Program program_;
  gl::Defines defines_;
  gl::VertexArray fullscreen_{"fullscreen"};
};

}  // namespace

const ParameterTable& table() {
  return parameter_table<Parameters>();
}
std::unique_ptr<Technique> make() {
  return std::make_unique<MyTechnique>();
}

}  // namespace pellucid::my_technique
