#pragma once

#include <map>
#include <string>
#include <vector>

#include "algorithms/raster/forward_pass.hpp"
#include "algorithms/translucent_relief/caustics.hpp"
#include "algorithms/translucent_relief/native_errors.hpp"
#include "algorithms/translucent_relief/relief_maps.hpp"
#include "algorithms/translucent_relief/translucent_relief.hpp"
#include "gl/program.hpp"

namespace pellucid::translucent_relief {

/// Draws the meshes that carry reliefs.
class ReliefPass {
 public:
  /// Keeps the address.
  explicit ReliefPass(const Parameters& parameters) : parameters_(parameters) {}

  /// InputError: a mesh without tangents.
  void prepare(const Scene&);
  /// Takes over what changed: maps, and what is compiled in.
  void update(const Scene&, const ForwardPass&);
  /// Into the target, over its depth and over the objects in it, which are refracted and reflected.
  void draw(const Scene&, const Camera&, const ForwardPass&, const Target&);
  std::string reload_shaders();

  /// For `pellucid bench`: counts the fetches of draw() and writes down each pixel's searches for draw_bare(), which
  /// makes the same. Where fragments lie over each other, those of the one that is drawn last.
  struct FetchCounts {
    double pixels = 0, fetches = 0;
  };
  FetchCounts count_fetches(const Scene&, const Camera&, const ForwardPass&);
  void draw_bare(const Scene&, const Camera&, const ForwardPass&) const;

  /// The view rays of such a frame beside exact ones.
  SearchErrors compare_searches(const Scene&, const Camera&, const ForwardPass&) const;

 private:
  bool two_layers(const Relief&) const;
  gl::Defines defines(const Relief&, const ForwardPass&) const;
  void copy_objects(const Target&);
  void draw_caustics(const Scene&, int instance, const Camera&, const ForwardPass&);
  void set_uniforms(const Scene&, const Instance&, const Camera&, const gl::Program&) const;
  void draw_mesh(const Scene&, const Instance&, const Camera&, const ForwardPass&, const gl::Program&) const;

  const Parameters& parameters_;
  std::map<int, ReliefMesh> meshes_;  // by the mesh's index in the scene
  std::vector<ReliefMaps> maps_;      // by relief
  std::map<int, Caustics> caustics_;  // by instance
  Animation animation_;
  bool objects_ = false;  // some opaque objects may be refracted
  gl::Texture object_color_, object_depth_;
  std::vector<gl::Program> bare_;  // by relief
  gl::Texture records_;
  std::map<gl::Defines, gl::Program> programs_;
  std::vector<const gl::Program*> program_of_;  // by relief
};

}  // namespace pellucid::translucent_relief
