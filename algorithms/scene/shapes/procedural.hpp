#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/scene/scene.hpp"

/// Geometry and volumes made by formula, deterministic for a seed on every platform. Lengths in metres.
namespace pellucid {

Mesh make_sphere(float radius, int segments);                  ///< `segments` around, half as many from pole to pole
Mesh make_box(const glm::vec3& size);                          ///< centred on the origin, flat normals
Mesh make_plane(const glm::vec2& size, int segments);          ///< in y = 0, centred, facing +y, uv in [0,1]²
Mesh make_cylinder(float radius, float height, int segments);  ///< from y = 0 up, capped
Mesh make_cone(float radius, float height, int segments);      ///< from y = 0 up, capped
Mesh make_torus(float major_radius, float minor_radius, int segments);
/// Star-shaped: the radius in the direction u at the angle φ about the y axis is radius·(1 +
/// amplitude·ρ²·cos(lobes·φ)), ρ the sine of the angle between u and that axis. A ball at amplitude 0.
struct StarOptions {
  float radius = 1.0F;
  int lobes = 3;
  float amplitude = 0.35F;  ///< 0 to below 1
};
double star_radius(const StarOptions&, const glm::dvec3& direction);      ///< `direction` unit
glm::dvec3 star_normal(const StarOptions&, const glm::dvec3& direction);  ///< unit, outward, of the surface there
Mesh make_star(const StarOptions&, int segments);                         ///< as make_sphere(); exact normals
/// Newell's 32 bicubic patches (at most 2·subdivisions² triangles each), bottom included: stands on y = 0, the spout
/// towards +x; the body's radius is `scale`, the height 1.575·scale. Lid, body, handle and spout are separate shells.
Mesh make_teapot(float scale, int subdivisions);
/// A plane in y = 0 with `segments` squares along its shorter side, raised by noise within ±height_m/2: sand, rock.
/// Its sides reach down to −height_m/2; there is no bottom.
struct ReliefOptions {
  glm::vec2 size{1.0F};
  int segments = 64;
  float height_m = 0.1F;
  float frequency = 3.0F;  ///< noise periods along the shorter side
  int octaves = 3;
  float ripples = 0.0F;  ///< share of the height that wind or waves have left as ripples
  std::uint32_t seed = 1;
};
Mesh make_relief(const ReliefOptions&);

/// A plane in y = 0, centred, facing +y, uv in [0,1]², of tiles or bricks in vertex colours that multiply the albedo.
struct TileOptions {
  glm::vec2 size{1.0F};
  int columns = 8, rows = 8;
  float joint = 0.05F;    ///< width of the joints, a share of a tile's side
  bool running = false;   ///< every other course moved by half a brick, tones at random; else a chequered pattern
  float contrast = 0.6F;  ///< the darkest tile's tone is 1 − contrast
  float hue = 0.2F;       ///< how far a tile's channels may fall below its tone
  std::uint32_t seed = 1;
};
Mesh make_tiles(const TileOptions&);

/// A ground with relief and many trees of a few kinds, each kind a few meshes that are instanced, finer near the
/// clearing. Appends meshes, materials and instances to `scene`. Instances are called ground, tree_0 … and
/// undergrowth_0 …
struct ForestOptions {
  glm::vec2 extent{60.0F};  ///< of the ground, centred
  int trees = 300;
  float clearing_radius = 4.0F;  ///< no trunk this near to `clearing`
  glm::vec2 clearing{0.0F};      ///< x, z
  float relief_m = 1.5F;         ///< height of the ground's undulation, about 0
  std::uint32_t seed = 1;
  float undergrowth = 1.5F;  ///< ferns, rocks and fallen trunks for each tree
};
/// Throws InputError when the clearing leaves no room for the trees.
void add_forest(Scene& scene, const ForestOptions&);

/// Height of that ground at (x, z).
float forest_ground_height(const ForestOptions&, float x, float z);

/// Voxels of density in [0, 1], x fastest, y up.
std::vector<float> make_constant_density(const glm::ivec3& size, float density);
struct FogOptions {
  std::uint32_t seed = 1;
  int octaves = 4;
  float frequency = 3.0F;       ///< noise periods across the box
  float height_falloff = 3.0F;  ///< density falls as exp(−falloff · y) with y in [0, 1]
  float contrast = 0.7F;        ///< 0: no noise, 1: noise down to zero
};
std::vector<float> make_fog_density(const glm::ivec3& size, const FogOptions&);
/// Uniform ball that touches the box's faces, 1 inside and 0 outside, the border voxels by their covered share (Fig.
/// 1a).
std::vector<float> make_ball_density(const glm::ivec3& size);

/// A plume that rises from the middle of the bottom, widens, winds and thins out; nothing at the box's faces.
struct SmokeOptions {
  std::uint32_t seed = 1;
  int octaves = 4;
  float frequency = 4.0F;  ///< noise periods across the box
  float contrast = 0.8F;   ///< 0: an even plume, 1: wisps with nothing between them
  float swirl = 0.5F;      ///< how far it winds off its axis at the top, as a share of the box's width
};
std::vector<float> make_smoke_density(const glm::ivec3& size, const SmokeOptions&);

/// Water up to a wavy surface, denser with depth and a little uneven; nothing above it.
struct WaterOptions {
  std::uint32_t seed = 1;
  int octaves = 2;
  float frequency = 2.0F;       ///< noise periods across the box
  float contrast = 0.2F;        ///< of that noise, 0 to 1
  float depth_gradient = 0.3F;  ///< density grows from 1 − gradient at the level to 1 at the bottom
  float level = 0.9F;           ///< mean height of the surface, a share of the box's
  float wave = 0.01F;           ///< its waves' amplitude, likewise
};
std::vector<float> make_water_density(const glm::ivec3& size, const WaterOptions&);

/// A spot's cone of light in a box around it: local z along the light from `near_m` to `range_m` from it, x and y
/// across the cone's widest section, its axis in the middle.
struct ConeShape {
  double near_m = 0.05, range_m = 1;
  double inner_angle_deg = 20, outer_angle_deg = 30;  ///< as the Light's; below 90
};
/// Irradiance over intensity [1/m²] at the voxels' centres: the spot's falloff over the squared distance. Nothing else
/// of the light matters, neither where it is nor where it points (Imagire et al. 2007, Sec. 5 and Fig. 11).
std::vector<float> make_cone_scattering(const glm::ivec3& size, const ConeShape&);

}  // namespace pellucid
