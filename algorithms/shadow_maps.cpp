// Variance shadow maps: Donnelly and Lauritzen 2006 (references.bib: donnelly2006).
#include "algorithms/shadow_maps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/gtc/matrix_transform.hpp>

#include "algorithms/scene/bounds.hpp"

namespace pellucid {
namespace {

constexpr int kMaxLayers = 6 * kMaxLights;

// shadows.glsl's std140 block.
struct ShadowBlock {
  std::array<glm::mat4, kMaxLayers> world_to_shadow;
  std::array<glm::vec4, kMaxLights> first_layer_range;
  glm::vec4 bleeding_variance;
};

glm::vec3 any_perpendicular(const glm::vec3& axis) {
  return std::abs(axis.y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
}

float farthest(const Bounds& bounds, const glm::vec3& from) {
  const glm::vec3 reach = glm::max(glm::abs(bounds.min - from), glm::abs(bounds.max - from));
  return glm::length(reach);
}

}  // namespace

void ShadowMaps::fit(const Scene& scene, const ShadowSettings& settings) {
  layers_.clear();
  first_layer_.assign(scene.lights.size(), -1);
  const Bounds bounds = world_bounds(scene);
  const glm::vec3 center = 0.5F * (bounds.min + bounds.max);
  const float radius = 0.5F * glm::length(bounds.max - bounds.min);
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    if (!light.casts_shadow) continue;
    first_layer_[i] = static_cast<int>(layers_.size());
    if (light.kind == LightKind::directional) {
      // A sphere about the scene, seen along the light; depth runs from the sphere's near side.
      const glm::vec3 origin = center - light.direction * radius;
      const glm::mat4 view = glm::lookAt(origin, center, any_perpendicular(light.direction));
      const glm::mat4 projection = glm::ortho(-radius, radius, -radius, radius, 0.0F, 2 * radius);
      layers_.push_back({projection * view, origin, light.direction, 2 * radius});
      continue;
    }
    const float range = std::max(farthest(bounds, light.position), 1e-3F);
    const float near = range * 1e-3F;
    if (light.kind == LightKind::spot) {
      // A margin of the blur's reach keeps its filter off the map's border.
      const float half = std::min(glm::radians(light.outer_angle_deg), glm::radians(85.0F));
      const float margin = 1 + 2 * (3 * settings.blur + 1) / static_cast<float>(settings.size);
      const float fov = 2 * std::atan(std::tan(half) * margin);
      const glm::mat4 view =
          glm::lookAt(light.position, light.position + light.direction, any_perpendicular(light.direction));
      layers_.push_back({glm::perspective(fov, 1.0F, near, range) * view, light.position, glm::vec3(0.0F), range});
      continue;
    }
    const float margin = 1 + 2 * (3 * settings.blur + 1) / static_cast<float>(settings.size);
    const float fov = 2 * std::atan(margin);
    for (const glm::vec3& axis : {glm::vec3(1, 0, 0), glm::vec3(-1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, -1, 0),
                                  glm::vec3(0, 0, 1), glm::vec3(0, 0, -1)}) {
      const glm::mat4 view = glm::lookAt(light.position, light.position + axis, any_perpendicular(axis));
      layers_.push_back({glm::perspective(fov, 1.0F, near, range) * view, light.position, glm::vec3(0.0F), range});
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
    draw_ = gl::Program("shadow moments", {"algorithms/shaders/common/opaque.vert.glsl",
                                           "algorithms/shaders/common/shadow_moments.frag.glsl"});
    blur_ = gl::Program("shadow blur", {"algorithms/shaders/common/fullscreen.vert.glsl",
                                        "algorithms/shaders/common/shadow_blur.frag.glsl"});
    block_ = gl::Buffer("shadows", sizeof(ShadowBlock), GL_STREAM_DRAW);
    fullscreen_ = gl::VertexArray("shadow blur");
  }
  allocate(settings);

  ShadowBlock block{};
  block.bleeding_variance = glm::vec4(settings.bleeding, settings.min_variance, 0, 0);
  for (std::size_t i = 0; i < layers_.size(); ++i)
    block.world_to_shadow[i] = layers_[i].world_to_clip;
  for (std::size_t i = 0; i < kMaxLights; ++i) {
    const int first = i < first_layer_.size() ? first_layer_[i] : -1;
    const float range = first < 0 ? 1.0F : layers_[static_cast<std::size_t>(first)].range_m;
    // A directional light's depth is measured from the world's origin in the shader.
    const float offset = first < 0 ? 0.0F
                                   : glm::dot(layers_[static_cast<std::size_t>(first)].origin,
                                              layers_[static_cast<std::size_t>(first)].axis);
    block.first_layer_range[i] = glm::vec4(static_cast<float>(first), 1 / range, offset, 0);
  }
  block_.upload(std::span<const ShadowBlock>(&block, 1));

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
