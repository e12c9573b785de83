#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "algorithms/raster/object_vertices.hpp"
#include "algorithms/raster/shadow_maps.hpp"
#include "algorithms/scene/scene.hpp"
#include "algorithms/scene/shapes/bounds.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace pellucid {

/// Which objects a pass draws: those that the forward pass shades, the optical ones (mirrors, metals, dielectrics), or
/// both.
enum class Objects { lambertian, optical, all };

/// The opaque objects, the lights and the environment behind everything: what all techniques share, drawn one way.
class ForwardPass {
 public:
  explicit ForwardPass(const Scene&);

  /// Takes over what changed since the last call: transforms, materials, lights, environment, and with `meshes` the
  /// geometry too.
  void update(const Scene&, bool meshes);

  /// After a frame: frees the instances that were gathered for cameras, lights or objects which it did not use.
  void end_frame();

  /// Shaded opaque objects into the bound framebuffer. Unless `keep_depth`, depth is cleared and written; with it, the
  /// depth of an earlier pass over the same geometry is reused and only visible fragments are shaded. A second colour
  /// attachment, if there is one, receives the distance from the eye [m].
  void draw_opaque(const Camera&, bool keep_depth) const;
  /// The environment, where the bound framebuffer's depth is still that of the far plane: after whatever would hide it,
  /// so that no pixel of it is shaded in vain.
  void draw_background(const Camera&) const;
  /// Both.
  void draw_shaded(const Camera&, bool keep_depth) const;

  /// Objects alone, with another fragment shader behind `opaque.vert.glsl`; sets its uniform `world_to_clip`, clears
  /// and writes depth.
  void draw_geometry(const Camera&, const gl::Program&) const;
  void draw_geometry(const glm::mat4& world_to_clip, const gl::Program&, Objects = Objects::lambertian) const;

  /// One object, by its index in the scene, with a program whose vertex stage takes what `opaque.vert.glsl` takes; sets
  /// its uniform `world_to_clip`. Depth, blending and culling are as the caller has set them.
  void draw_instance(const Scene&, int instance, const glm::mat4& world_to_clip, const gl::Program&) const;

  /// Objects alone with the program in use, whose vertex stage takes what `opaque.vert.glsl` takes and which transforms
  /// them itself: all of them, each `copies` times one after the other (gl_InstanceID / copies tells which), or one by
  /// its index, or those that `world_to_clip` sees.
  void draw_all(Objects, int copies) const;
  void draw_alone(const Scene&, int instance, int copies) const;
  void draw_seen(const glm::mat4& world_to_clip, Objects objects) const { draw_visible(world_to_clip, objects); }

  /// Opaque objects only, unshaded: albedo, distance from the eye [m], unit normal and emission into the four colour
  /// attachments of the bound framebuffer; clears and writes depth.
  void draw_surface_points(const Camera&);

  /// Draws the shadow maps of the lights that cast shadows, unless the settings allow keeping those of the last frame.
  void update_shadows(const Scene&, const ShadowSettings&);
  bool shadowed() const { return shadowed_; }

  /// Binds what environment.glsl reads, the image to texture unit 0, for a program compiled with environment_defines().
  void bind_environment(const gl::Program&) const;
  gl::Defines environment_defines() const;

  /// Binds what lighting.glsl and shadows.glsl read: the lights' uniform block, and shadow maps where there are any.
  void bind_lights() const;
  /// ambient + Σ E / 4π where no light depends on the place (medium_source() of medium.glsl).
  const glm::vec3& uniform_incident() const { return uniform_incident_; }
  /// The defines that a program which includes them must be compiled with: number and kinds of the lights, SHADOWS and
  /// their shadow maps where a light casts shadows, or UNIFORM_SOURCE where no light's irradiance depends on the place.
  const gl::Defines& light_defines() const { return light_defines_; }
  std::string reload_shaders();

 private:
  struct Vertices {
    gl::Buffer vertices, indices;
    int index_count = 0;
    Bounds bounds;  // of the mesh
  };
  struct Batch {
    gl::Buffer instances;
    gl::VertexArray array;
    int instance_count = 0;
    mutable std::uint64_t used_in = 0;  // which frame
  };
  // The part of each mesh that one camera or light sees.
  struct Visible {
    glm::mat4 world_to_clip{1.0F};
    Objects objects = Objects::lambertian;
    std::vector<Batch> batches;
    mutable std::uint64_t used_in = 0;
  };
  void upload_meshes(const Scene&);
  void gather_instances(const Scene&);
  void upload_lights(const Scene&);
  void upload_environment(const Scene&);
  void compile(const std::vector<Light>&);
  static InstanceAttributes attributes(const Scene&, const Instance&);
  Batch make_batch(std::size_t mesh, std::span<const InstanceAttributes>) const;
  const Visible& visible(const glm::mat4& world_to_clip, Objects) const;
  void draw_visible(const glm::mat4& world_to_clip, Objects) const;
  void draw_batch(std::size_t mesh, const Batch&, int copies) const;

  std::vector<Vertices> meshes_;
  std::vector<std::string> mesh_names_;
  std::vector<std::vector<InstanceAttributes>> lambertian_, optical_;  // by mesh
  mutable std::vector<Visible> visible_;                               // of the last cameras and lights, newest last
  mutable std::map<int, Batch> alone_;                                 // instances drawn by themselves
  mutable std::map<Objects, std::vector<Batch>> everything_;           // instances seen or not
  std::uint64_t frame_ = 1;
  gl::Buffer lights_;
  gl::Texture environment_;
  Environment gradient_;
  bool uniform_lighting_ = true;
  glm::vec3 uniform_incident_{0.0F};
  std::uint64_t revision_ = 0;
  ShadowMaps shadows_;
  std::optional<std::uint64_t> shadow_revision_;
  bool shadowed_ = false;  // some light casts shadows
  gl::Defines light_defines_;
  gl::Program opaque_, background_, surface_points_;
  gl::VertexArray fullscreen_;
};

}  // namespace pellucid
