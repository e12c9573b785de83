// Variance shadow maps: Donnelly and Lauritzen 2006 (references.bib: donnelly2006).
#include "algorithms/raster/shadow_maps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>

#include <glm/gtc/matrix_transform.hpp>

#include "algorithms/scene/shapes/bounds.hpp"

namespace pellucid {
namespace {

constexpr int kCubeLayers = 6;
constexpr float kWidestMapDeg = 85.0F;  // half-angle of a spot's map

// shadows.glsl's std140 block.
struct ShadowBlock {
  struct Entry {
    std::array<glm::vec4, 3> to_map;
    glm::vec4 range;
  };
  std::array<Entry, kMaxLights> shadows;
  glm::vec4 bleeding_variance;
};

glm::vec3 any_perpendicular(const glm::vec3& axis) {
  return std::abs(axis.y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
}

float farthest(const Bounds& bounds, const glm::vec3& from) {
  const glm::vec3 reach = glm::max(glm::abs(bounds.min - from), glm::abs(bounds.max - from));
  return glm::length(reach);
}

glm::vec4 row(const glm::mat4& m, int i) {
  return {m[0][i], m[1][i], m[2][i], m[3][i]};
}

}  // namespace

std::vector<int> shadow_layers(const std::vector<Light>& lights) {
  std::vector<int> first;
  int layers = 0;
  for (const Light& light : lights) {
    first.push_back(light.casts_shadow ? layers : -1);
    if (light.casts_shadow) layers += light.kind == LightKind::point ? kCubeLayers : 1;
  }
  return first;
}

bool lit_beyond_map(const Light& light) {
  return light.kind == LightKind::spot && light.outer_angle_deg > kWidestMapDeg;
}

void ShadowMaps::fit(const Scene& scene, const ShadowSettings& settings) {
  layers_.clear();
  first_layer_ = shadow_layers(scene.lights);
  const Bounds bounds = world_bounds(scene);
  const glm::vec3 center = 0.5F * (bounds.min + bounds.max);
  const float radius = 0.5F * glm::length(bounds.max - bounds.min);
  // A margin of the blur's reach keeps its filter off a map's border.
  const float margin = 1 + 2 * (3 * settings.blur + 1) / static_cast<float>(settings.size);
  for (const Light& light : scene.lights) {
    if (!light.casts_shadow) continue;
    if (light.kind == LightKind::directional) {
      // A sphere about the scene, seen along the light; depth runs from the sphere's near side.
      const glm::vec3 origin = center - light.direction * radius;
      const glm::mat4 view = glm::lookAt(origin, center, any_perpendicular(light.direction));
      const glm::mat4 projection = glm::ortho(-radius, radius, -radius, radius, 0.0F, 2 * radius);
      layers_.push_back({projection * view, origin, light.direction, 2 * radius, 1.0F});
      continue;
    }
    const float range = std::max(farthest(bounds, light.position), 1e-3F);
    const float near = range * 1e-3F;
    if (light.kind == LightKind::spot) {
      const float extent = std::tan(glm::radians(std::min(light.outer_angle_deg, kWidestMapDeg))) * margin;
      const float fov = 2 * std::atan(extent);
      const glm::mat4 view =
          glm::lookAt(light.position, light.position + light.direction, any_perpendicular(light.direction));
      layers_.push_back(
          {glm::perspective(fov, 1.0F, near, range) * view, light.position, glm::vec3(0.0F), range, extent});
      continue;
    }
    const float fov = 2 * std::atan(margin);
    for (const glm::vec3& axis : {glm::vec3(1, 0, 0), glm::vec3(-1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, -1, 0),
                                  glm::vec3(0, 0, 1), glm::vec3(0, 0, -1)}) {
      const glm::mat4 view = glm::lookAt(light.position, light.position + axis, any_perpendicular(axis));
      layers_.push_back(
          {glm::perspective(fov, 1.0F, near, range) * view, light.position, glm::vec3(0.0F), range, margin});
    }
  }
}

void ShadowMaps::allocate(const ShadowSettings& settings) {
  const int count = static_cast<int>(layers_.size());
  if (moments_ && moments_.width() == settings.size && moments_.depth() == count) return;
  moments_ = gl::Texture::make_2d_array("shadow moments", gl::Format::rg32f, settings.size, settings.size, count);
  moments_.set_sampling(gl::Filter::linear, gl::Wrap::clamp);
  scratch_ = gl::Texture::make_2d_array("shadow blur", gl::Format::rg32f, settings.size, settings.size, 1);
  depth_ = gl::Texture::make_2d("shadow depth", gl::Format::depth32f, settings.size, settings.size);
  layer_framebuffers_.clear();
  scratch_framebuffers_.clear();
  for (int i = 0; i < count; ++i) {
    layer_framebuffers_.push_back(gl::Framebuffer::layered("shadow layer", moments_, &depth_, i));
  }
  scratch_framebuffers_.push_back(gl::Framebuffer::layered("shadow blur", scratch_, nullptr, 0));
}

void ShadowMaps::update(const Scene& scene, const ShadowSettings& settings, const DrawGeometry& draw) {
  fit(scene, settings);
  if (layers_.empty()) return;
  if (!draw_) {
    draw_ = gl::Program("shadow moments",
                        {"algorithms/shaders/opaque.vert.glsl", "algorithms/shaders/shadow_moments.frag.glsl"});
    blur_ = gl::Program("shadow blur",
                        {"algorithms/shaders/fullscreen.vert.glsl", "algorithms/shaders/shadow_blur.frag.glsl"});
    block_ = gl::Buffer("shadows", sizeof(ShadowBlock), GL_STREAM_DRAW);
    fullscreen_ = gl::VertexArray("shadow blur");
  }
  allocate(settings);

  upload(scene, settings);
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    layer_framebuffers_[i].bind();
    layer_framebuffers_[i].clear_color(0, {1, 1, 0, 0});
    draw_.set("light_origin", layers_[i].origin);
    draw_.set("light_axis", layers_[i].axis);
    draw_.set("inverse_range", 1 / layers_[i].range_m);
    draw(layers_[i].world_to_clip, draw_);
  }
  if (settings.blur > 0) blur(settings);
}

void ShadowMaps::upload(const Scene& scene, const ShadowSettings& settings) {
  ShadowBlock block{};
  block.bleeding_variance = glm::vec4(settings.bleeding, 1 / (1 - settings.bleeding), settings.min_variance, 0);
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    if (first_layer_[i] < 0) continue;
    const Layer& layer = layers_[static_cast<std::size_t>(first_layer_[i])];
    ShadowBlock::Entry& out = block.shadows[i];
    // From [−1, 1] to texture coordinates.
    out.to_map[0] = 0.5F * (row(layer.world_to_clip, 0) + row(layer.world_to_clip, 3));
    out.to_map[1] = 0.5F * (row(layer.world_to_clip, 1) + row(layer.world_to_clip, 3));
    out.to_map[2] = glm::vec4(layer.axis, -glm::dot(layer.origin, layer.axis)) / layer.range_m;
    out.range = glm::vec4(1 / layer.range_m, 0.5F / layer.tan_half_angle, 0, 0);
  }
  block_.upload(std::span<const ShadowBlock>(&block, 1));
}

void ShadowMaps::blur(const ShadowSettings& settings) {
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  blur_.use();
  blur_.set("sigma", settings.blur);
  fullscreen_.bind();
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    scratch_framebuffers_[0].bind();
    moments_.bind(0);
    blur_.set("layer", static_cast<int>(i));
    blur_.set("direction", glm::ivec2(1, 0));
    glDrawArrays(GL_TRIANGLES, 0, 3);
    layer_framebuffers_[i].bind();
    scratch_.bind(0);
    blur_.set("layer", 0);
    blur_.set("direction", glm::ivec2(0, 1));
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }
  glEnable(GL_DEPTH_TEST);
}

void ShadowMaps::bind() const {
  block_.bind_uniform(1);
  moments_.bind(2);
}

std::string ShadowMaps::reload_shaders() {
  std::string words;
  for (gl::Program* program : {&draw_, &blur_}) {
    if (*program) words += program->reload();
  }
  return words;
}

}  // namespace pellucid
