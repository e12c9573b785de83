#include "algorithms/translucent_relief/caustics.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "algorithms/translucent_relief/caustic_charts.hpp"

namespace pellucid::translucent_relief {
namespace {

constexpr GLuint kMapsUnit = 13, kNodesUnit = 14, kLayersBinding = 2;
constexpr std::uint32_t kRepeatsOverU = 0x100, kRepeatsOverV = 0x200;
constexpr int kTexelsOfNode = static_cast<int>(sizeof(CausticNode) / sizeof(glm::vec4));

}  // namespace

void Caustics::lay_out(const Scene& scene, const Instance& instance, int side, bool repeat) {
  const CausticCharts charts = caustic_charts(scene.meshes[static_cast<std::size_t>(instance.mesh)], side,
                                              fmt::format("'{}' of scene '{}'", instance.name, scene.name));
  const int layers = static_cast<int>(charts.layers.size());
  nodes_ = gl::Texture::make_2d_array("caustic nodes", gl::Format::rgba32f, side, side, layers * kTexelsOfNode);
  std::vector<glm::vec4> texels(charts.layers[0].size());
  for (int layer = 0; layer < layers * kTexelsOfNode; ++layer) {
    const std::vector<CausticNode>& nodes = charts.layers[static_cast<std::size_t>(layer / kTexelsOfNode)];
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const glm::vec4* members[] = {&nodes[i].position, &nodes[i].normal, &nodes[i].over_u, &nodes[i].over_v};
      texels[i] = *members[layer % kTexelsOfNode];
    }
    nodes_.upload_layer(layer, std::span(&texels[0].x, 4 * texels.size()));
  }
  // As relief.frag.glsl reads them: where the maps repeat over the mesh's own edge, light is looked up on the other
  // side.
  std::vector<std::uint32_t> words = charts.layer_of_triangle;
  for (std::uint32_t& word : words) {
    const glm::bvec2 closes = charts.closes[word];
    if (repeat && (closes.x || charts.affine)) word |= kRepeatsOverU;
    if (repeat && (closes.y || charts.affine)) word |= kRepeatsOverV;
  }
  layer_of_triangle_ = gl::Buffer("caustic layers", std::span<const std::uint32_t>(words));
  closes_ = charts.closes;
  repeat_ = repeat;
}

void Caustics::update(const Scene& scene, const Instance& instance, int resolution, const gl::Defines& defines,
                      const std::function<void(const gl::Program&)>& set_uniforms) {
  if (!program_ || defines != defines_) {
    const std::string folder = "algorithms/translucent_relief/";
    program_ = gl::Program("caustics", {folder + "caustics.vert.glsl", folder + "caustics.frag.glsl"}, defines);
    defines_ = defines;
    grid_ = gl::VertexArray("caustics");
  }
  const int cells = std::max(1, resolution / 2);
  const bool copies = !scene.reliefs[static_cast<std::size_t>(instance.relief)].cut;
  const int lights = static_cast<int>(scene.lights.size());
  if (!nodes_ || nodes_.width() != cells + 1 || repeat_ != copies) lay_out(scene, instance, cells + 1, copies);
  const int charts = static_cast<int>(closes_.size());
  if (!maps_ || maps_.width() != resolution || maps_.depth() != std::max(1, lights * charts))
    maps_ = gl::Texture::make_2d_array("caustics", gl::Format::rgba32f, resolution, resolution,
                                       std::max(1, lights * charts));
  maps_.set_sampling(gl::Filter::linear, gl::Wrap::repeat);
  program_.use();
  set_uniforms(program_);
  nodes_.bind(kNodesUnit);
  program_.set("cut", false);
  program_.set("copies", copies);
  program_.set("grid", cells);
  program_.set("resolution", static_cast<float>(resolution));
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  grid_.bind();
  for (int light = 0; light < lights; ++light) {
    for (int chart = 0; chart < charts; ++chart) {
      const gl::Framebuffer target = gl::Framebuffer::layered("caustics", maps_, nullptr, light * charts + chart);
      target.bind();
      target.clear_color(0, {0, 0, 0, 0});
      program_.set("light", light);
      program_.set("chart", chart);
      program_.set("closes", glm::ivec2(closes_[static_cast<std::size_t>(chart)]));
      glDrawArraysInstanced(GL_TRIANGLES, 0, 6 * cells * cells, copies ? 9 : 1);
    }
  }
  glDisable(GL_BLEND);
}

void Caustics::bind() const {
  maps_.bind(kMapsUnit);
  layer_of_triangle_.bind_storage(kLayersBinding);
}

}  // namespace pellucid::translucent_relief
