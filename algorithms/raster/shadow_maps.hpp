#pragma once

#include <functional>
#include <string>
#include <vector>

#include "algorithms/parameters.hpp"
#include "algorithms/scene/scene.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace pellucid {

/// Settings of the shadow maps, common to all techniques; named with the prefix `shadow.`.
enum class ShadowRefresh { changed, every_frame };
struct ShadowSettings {
  int size = 256;
  float blur = 1.0F;
  float bleeding = 0.2F;
  float min_variance = 1e-6F;
  ShadowRefresh refresh = ShadowRefresh::every_frame;

  static constexpr void parameters(auto& self, auto&& visit) {
    visit(PARAM(size), {.range = {16, 4096},
                        .cite = "Imagire et al. 2007, Sec. 5",
                        .doc = "width and height of a variance shadow map",
                        .when = Change::precompute,
                        .unit = "texels"});
    visit(PARAM(blur), {.symbol = "σ",
                        .range = {0, 16},
                        .cite = "Donnelly and Lauritzen 2006, Sec. 3",
                        .doc = "standard deviation of the Gaussian that blurs the moments, 0 for none",
                        .unit = "texels"});
    visit(PARAM(bleeding), {.range = {0, 0.95},
                            .cite = "beyond the paper",
                            .doc = "lowest share of Chebyshev's bound that counts as shadow"});
    visit(PARAM(min_variance), {.range = {0, 0.01},
                                .cite = "Donnelly and Lauritzen 2006, Sec. 4",
                                .doc = "least variance, in squares of the light's depth range, against shadow acne"});
    visit(PARAM(refresh),
          {.cite = "Imagire et al. 2007, Sec. 4",
           .doc = "draw the maps only when light or geometry changed, or in every frame as with moving lights",
           .choices = "changed|every_frame"});
  }
};
static_assert(well_formed<ShadowSettings>());

/// The first layer of each light's shadow maps, −1 for a light that casts no shadow.
std::vector<int> shadow_layers(const std::vector<Light>&);
/// True for a spot of a wider cone than its shadow map can see; beyond the map it casts no shadow.
bool lit_beyond_map(const Light&);

/// Variance shadow maps of the lights that cast shadows: one layer of depth moments for a directional or spot light,
/// six with a guard band for a point light.
class ShadowMaps {
 public:
  /// Draws the opaque geometry with a program behind opaque.vert.glsl, given the layer's clip transform.
  using DrawGeometry = std::function<void(const glm::mat4& world_to_clip, const gl::Program&)>;

  /// Fits the layers to the scene's lights and bounds. Nothing is drawn when no light casts a shadow.
  void update(const Scene&, const ShadowSettings&, const DrawGeometry&);
  /// True if any light casts a shadow: programs then need the define SHADOWS.
  bool active() const { return !layers_.empty(); }
  /// Binds the uniform block (binding 1) and the moments (unit 2) of shadows.glsl.
  void bind() const;
  std::string reload_shaders();

 private:
  struct Layer {
    glm::mat4 world_to_clip{1.0F};
    glm::vec3 origin{0.0F};
    glm::vec3 axis{0.0F};  ///< depth along it for directional lights, zero where depth is a distance
    float range_m = 1;
    float tan_half_angle = 1;  ///< of what the map sees, where depth is a distance
  };
  void fit(const Scene&, const ShadowSettings&);
  void allocate(const ShadowSettings&);
  void upload(const Scene&, const ShadowSettings&);
  void blur(const ShadowSettings&);

  std::vector<Layer> layers_;
  std::vector<int> first_layer_;
  gl::Texture moments_, scratch_, depth_;
  std::vector<gl::Framebuffer> layer_framebuffers_, scratch_framebuffers_;
  gl::Buffer block_;
  gl::Program draw_, blur_;
  gl::VertexArray fullscreen_;
};

}  // namespace pellucid
