#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "algorithms/parameters.hpp"
#include "algorithms/scene/images/image.hpp"
#include "algorithms/scene/relief/relief.hpp"

/// A scene is plain data, in metres and scene-linear Rec. 709 radiance, right-handed, y up. It knows no GL.
namespace pellucid {

struct Mesh {
  std::string name;
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;  ///< unit, one per position
  std::vector<glm::vec3> colors;   ///< empty, or one per position; multiplies the albedo
  std::vector<glm::vec2> uvs;      ///< empty, or one per position
  std::vector<glm::uvec3> triangles;
};

/// How a surface answers light: optics.hpp holds the laws. Lambertian surfaces are what the forward pass shades; the
/// others are *optical*: techniques draw them, the reference traces them.
enum class SurfaceKind {
  lambertian,  ///< albedo · (ambient + Σ E cos θ / π) + emission, the normal turned to the viewer's side (two-sided)
  mirror,      ///< reflects `reflectance` of the light at every angle
  metal,       ///< reflects by Fresnel's term with extinction, times `reflectance`
  dielectric,  ///< bounds a solid of another index: a closed mesh, its triangles counter-clockwise from outside
};
struct Material {
  std::string name;
  glm::vec3 albedo{0.5F};
  glm::vec3 emission{0.0F};  ///< radiance
  SurfaceKind kind = SurfaceKind::lambertian;
  glm::vec3 reflectance{1.0F};
  glm::vec3 metal_n{1.0F}, metal_k{5.0F};  ///< a metal's complex index n + ik, per channel
  float ior = 1.5F;                        ///< η of a dielectric, relative to what surrounds it
  glm::vec3 absorption{0.0F};  ///< of a dielectric [1/m]: e^(−absorption · path) remains (Beer–Lambert)
  glm::vec3 scattering{0.0F};  ///< of a dielectric's medium [1/m]; the albedo is its share of scattering + absorption
  float anisotropy = 0.0F;     ///< mean cosine of the scattering angle, Henyey and Greenstein's phase function
  bool optical() const { return kind != SurfaceKind::lambertian; }
  bool scatters() const { return kind == SurfaceKind::dielectric && scattering != glm::vec3(0.0F); }
};

/// One placed mesh.
struct Instance {
  std::string name;
  int mesh = 0;
  int material = 0;
  glm::mat4 to_world{1.0F};
  glm::vec3 tint{1.0F};  ///< multiplies the albedo
  /// Where techniques with several cube maps in an object put them by hand: points in the mesh's space [m].
  std::vector<glm::vec3> cubes{};
  int relief = -1;  ///< index of the height fields that lie under the mesh; −1: none
};

enum class LightKind { directional, point, spot };

/// `intensity`: irradiance at normal incidence for directional lights [W/m²], radiant intensity for the others [W/sr].
struct Light {
  std::string name;
  LightKind kind = LightKind::directional;
  glm::vec3 position{0.0F};
  glm::vec3 direction{0.0F, -1.0F, 0.0F};  ///< unit, the way the light travels
  glm::vec3 intensity{1.0F};
  float inner_angle_deg = 20.0F;  ///< half-angle of the full cone of a spot
  float outer_angle_deg = 30.0F;  ///< half-angle at which a spot reaches zero (smoothstep of the cosine between)
  bool casts_shadow = false;      ///< opaque objects keep this light from surfaces and from the medium
};
inline constexpr int kMaxLights = 4;

/// The meaning of a density: extinction and colour at it, linear between two points and constant beyond the outermost.
struct TransferPoint {
  float density = 0;
  float extinction = 0;    ///< φ [1/m], times the volume's `extinction`
  glm::vec3 albedo{1.0F};  ///< times the volume's `albedo`
};

/// A box of voxels. `to_world` maps local coordinates [0,1]³ to the world, so its columns are the box's edges.
/// Voxel centres lie at (i + 1/2)/n; density is interpolated trilinearly and clamped at the border, and then mapped by
/// the transfer function, if there is one.
struct Volume {
  std::string name;
  glm::ivec3 size{1};
  std::vector<float> density;        ///< x fastest; ≥ 0, finite
  glm::vec2 file_range{0.0F, 1.0F};  ///< of a volume from a file: the values in it that became density 0 and 1
  glm::mat4 to_world{1.0F};
  float extinction = 1.0F;              ///< φ [1/m] at density 1
  glm::vec3 albedo{1.0F};               ///< single-scattering albedo
  glm::vec3 emission{0.0F};             ///< radiance added to the scattered one
  std::vector<TransferPoint> transfer;  ///< empty, or two or more points of rising density

  /// Imagire et al. 2007, Sec. 5 and Fig. 11: the index of the spotlight in whose space the volume lies, or −1. Its box
  /// then follows the light, and its voxels store what the light sends them: no other light is scattered in it.
  int light = -1;
  std::vector<float>
      scattering;  ///< with a light: irradiance over intensity [1/m²] at the voxels, unshadowed; as density

  glm::vec3 voxel_spacing_m() const;  ///< edge length of a voxel along each axis, in the world
};

/// Radiance from everywhere, times `scale`: a lat-long image (row 0 at +y; u = 1/2 at −z, 3/4 at +x; bilinear), or a
/// gradient, linear in direction.y from the horizon up to the zenith and down to the ground.
struct Environment {
  std::optional<Image> image;
  float scale = 1.0F;
  glm::vec3 zenith{0.0F}, horizon{0.0F}, ground{0.0F};  ///< without an image
  /// `direction` unit.
  glm::vec3 radiance(const glm::vec3& direction) const;
};

/// A named pinhole view.
struct View {
  std::string name;
  glm::vec3 eye{0.0F, 0.0F, 5.0F};
  glm::vec3 target{0.0F};
  glm::vec3 up{0.0F, 1.0F, 0.0F};
  float fov_y_deg = 45.0F;
  float near_m = 0.1F;
  float far_m = 1000.0F;
};

/// A view with its image size: what a technique renders and the reference traces. Pixel centres at +1/2.
struct Camera {
  View view;
  int width = 720;
  int height = 540;
  glm::mat4 world_to_view() const;
  glm::mat4 projection() const;  ///< OpenGL clip space
  /// Unit world direction through the image point (x, y) in pixels from the top left corner.
  glm::dvec3 ray_direction(double x, double y) const;
};

class SceneSource;

/// A scene file, loaded. `parameters()` exposes the scene's own parameters (without the prefix `scene.`); assigning one
/// changes the data below in place and raises `revision`. A ParameterRef holds the scene's address: take it again after
/// a move.
class Scene {
 public:
  std::string name;
  std::string title;
  std::string description;
  std::string stand_in;  ///< which mesh or data stands in for the paper's own; empty when none does
  std::vector<Mesh> meshes;
  std::vector<Material> materials;
  std::vector<Instance> instances;
  std::vector<Relief> reliefs;
  std::vector<Light> lights;
  std::optional<Volume> volume;
  Environment environment;
  glm::vec3 ambient{0.0F};  ///< radiance of the uniform ambient light on surfaces and in the medium
  std::vector<View> views;  ///< at least one; the first is the default

  const View& find_view(std::string_view name) const;  ///< empty: the first; InputError with the nearest name
  ParameterRef parameters();
  std::uint64_t revision() const;
  /// SHA-256 (hex) of the source text, the files it reads and the current parameter values.
  std::string content_hash() const;

  Scene();
  ~Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;

  std::shared_ptr<SceneSource> source;  ///< what parameters and paths re-evaluate; made by the loader
};

struct SceneInfo {
  std::string name, title, description, module;  ///< module: the folder it lies in
};

/// The material of `instance`; in place of it, its index among the scene's.
inline const Material& material_of(const Scene& scene, const Instance& instance) {
  return scene.materials[static_cast<std::size_t>(instance.material)];
}
inline const Material& material_of(const Scene& scene, int instance) {
  return material_of(scene, scene.instances[static_cast<std::size_t>(instance)]);
}

/// True if `instance` is not a surface that the forward pass shades: it carries a relief, or has a mirror's, a metal's
/// or a dielectric's material.
inline bool optical(const Scene& scene, const Instance& instance) {
  return instance.relief >= 0 || material_of(scene, instance).optical();
}

/// Scenes that are embedded in the binary (`algorithms/*/scenes/*.toml`), read cheaply: for `pellucid list`.
std::vector<SceneInfo> list_scenes();

/// `name_or_path`: a listed name, or a path ending in .toml. Every error is an InputError "file.toml:line:column: …".
Scene load_scene(const std::string& name_or_path);

}  // namespace pellucid
