#pragma once

#include <string>
#include <vector>

#include "algorithms/geocube/geocube.hpp"
#include "algorithms/geocube/glass_object.hpp"
#include "algorithms/geocube/native_errors.hpp"
#include "algorithms/raster/forward_pass.hpp"
#include "algorithms/raster/translucency.hpp"
#include "algorithms/technique.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace pellucid::geocube {

/// The number of a frame's texture fetches: a search's length differs from ray to ray.
struct FetchCounts {
  double pixels = 0;   ///< that show a dielectric
  double fetches = 0;  ///< of cube maps and the environment, by all of them
};

/// The pass that draws a scene's optical objects: their cubes, programs and buffers. A context must be current for
/// every call.
class GlassPass {
 public:
  /// Keeps the address of the parameters.
  explicit GlassPass(const Parameters& parameters) : parameters_(parameters) {}

  /// The cubes of every object. Throws InputError as GlassObject does.
  void prepare(const Scene&);
  /// Opaque objects, mirrors and metals, where rays enter dielectrics, and what is seen past all of these. Throws
  /// InputError for parameters that do not go together.
  void draw_entries(const Scene&, const Camera&, ForwardPass&, const Target&, gl::PassTimer&);
  /// The searches and their light, over draw_entries() of the same scene and camera.
  void draw_glass(const Scene&, const Camera&, const Target&) const;
  std::string reload_shaders();

  const std::vector<GlassObject>& objects() const { return objects_; }
  const Translucency& translucency() const { return translucency_; }
  /// The first searches of the pixels of draw_entries(), drawn again into textures, beside the true surfaces.
  SearchErrors compare_searches(const Scene&, const Camera&) const;

  /// For `pellucid bench`: counts the fetches of draw_glass() and keeps the counts for draw_bare(), which makes as many
  /// at each pixel, of the same textures, and nothing else with them than sums. Throws InputError unless the search
  /// runs in the fragment stage, by evaluated functions and a single layer.
  FetchCounts count_fetches(const Scene&, const Camera&, const ForwardPass&);
  void draw_bare(const Scene&, const Camera&, const Target&) const;

 private:
  void refresh(const Scene&);
  void compile(const gl::Defines& environment, const gl::Defines& medium);
  gl::Defines own_defines() const;
  void fit(int width, int height);
  gl::Framebuffer entry_framebuffer(const gl::Texture& depth) const;
  void set_search(const GlassObject&, const Material&, const gl::Program&) const;
  void draw_mirrors(const Scene&, const Camera&) const;
  void draw_object(const GlassObject&, const Scene&, const Camera&, const gl::Program&) const;
  void draw_pixels(const Scene&, const Camera&, const gl::Program&, const GlassObject* only) const;
  glm::mat3 pixel_to_ray(const Camera&, const glm::mat4& to_world) const;

  const Parameters& parameters_;
  mutable Translucency translucency_;  // keeps the media that it has met
  std::vector<GlassObject> objects_;
  gl::Texture function_table_;
  gl::Program entry_, glass_, reflect_, bare_;
  gl::Texture entries_, entry_cleared_, fetch_counts_;
  gl::VertexArray fullscreen_;
  gl::Defines defines_;
};

}  // namespace pellucid::geocube
