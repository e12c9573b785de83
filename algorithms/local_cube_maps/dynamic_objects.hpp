#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "algorithms/local_cube_maps/impostor_cube.hpp"
#include "algorithms/local_cube_maps/object_pixels.hpp"
#include "algorithms/local_cube_maps/refractor_map.hpp"
#include "algorithms/raster/forward_pass.hpp"
#include "algorithms/raster/translucency.hpp"
#include "algorithms/technique.hpp"
#include "gl/timer.hpp"

namespace pellucid::local_cube_maps {

/// The mirrors, metals and dielectrics of a scene, each with its own maps: the algorithm of Szirmay-Kalos et al. 2005,
/// Sec. 6, in its preparation phase (update) and its frame phase (draw).
class DynamicObjects {
 public:
  struct Object {
    int instance = 0;
    std::unique_ptr<ImpostorCube> cube;
    const RefractorMap* refractor = nullptr;  ///< of its mesh; null for a mirror or metal
    glm::vec3 reference{0.0F};                ///< o, where the maps were last drawn from
    std::uint64_t frame = 0;                  ///< when
    std::chrono::steady_clock::time_point time;
    bool drawn = false;
  };
  struct Cost {
    double last_ms = 0;           ///< of the last refreshes whose time is known, all objects together
    double total_ms = 0;          ///< of all of them
    std::uint64_t timed = 0;      ///< frames with refreshes whose time is known
    std::uint64_t refreshes = 0;  ///< maps drawn
    std::uint64_t frames = 0;
  };

  /// Drops the maps, finds the optical objects and, for two refractions, makes their refractor maps. Throws InputError
  /// when there is no such object.
  void prepare(const Scene&, const MapSettings&, const LookupSettings&, const char* technique);

  /// Draws the maps that are due; returns the indices of their objects.
  std::vector<std::size_t> due(const Scene&, const MapSettings&);
  void draw_maps(const Scene&, const ForwardPass&, const MapSettings&, const LookupSettings&,
                 const std::vector<std::size_t>& which);
  /// The other objects into the maps of each.
  void draw_mutual(const Scene&, const ForwardPass&, const MapSettings&, const LookupSettings&,
                   const std::vector<std::size_t>& which);

  /// All objects, behind what the target's depth holds.
  void draw(const Scene&, const ForwardPass&, const Camera&, const Target&, const MapSettings&, const LookupSettings&);
  /// Its two halves: which surface each pixel shows, and then its light, once a pixel. The target's framebuffer is
  /// bound after the second.
  void draw_surfaces(const Scene&, const ForwardPass&, const Camera&, const Target&);
  void shade(const Scene&, const Camera&, const Target&, const MapSettings&, const LookupSettings&);
  /// One object with the three outputs of report.frag.glsl.
  void draw_report(const Scene&, const ForwardPass&, const Camera&, const MapSettings&, const LookupSettings&,
                   const Object&);

  const std::vector<Object>& objects() const { return objects_; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  gl::PassTimer& cost_timer() { return *cost_timer_; }  ///< after prepare()
  const Cost& cost();
  std::string reload_shaders();

  /// The maps and uniforms that a program with lookup.glsl and refraction.glsl needs of an object.
  void bind(const Scene&, const Object&, const LookupSettings&, const gl::Program&) const;
  gl::Defines defines(SurfaceKind, const LookupSettings&) const;

 private:
  enum class Use { frame, cube, report };
  /// The shader of an object for a use, with the object bound.
  const gl::Program& bound(const Scene&, const Object&, Use, const MapSettings&, const LookupSettings&);
  const gl::Program& program(const Scene&, SurfaceKind, Use, const MapSettings&, const LookupSettings&);
  glm::vec3 center(const Scene&, const Object&) const;
  /// Leaves out the far side of a closed object that the eye is not in: a software rasteriser would shade it.
  void cull(const Scene&, const Object&, const glm::vec3& eye) const;
  glm::vec3 anchor(const Scene&, const Object&, const MapSettings&) const;
  std::optional<PixelArea> seen(const Scene&, const Object&, const Camera&) const;

  std::vector<Object> objects_;
  std::map<int, RefractorMap> refractors_;  // by mesh
  struct Extent {
    glm::vec3 middle{0.0F}, half{0.0F};  // of the bounding box
    bool closed = false;
  };
  std::map<int, Extent> extents_;  // by mesh, in its own space
  std::vector<std::string> warnings_;
  glm::vec3 proxy_min_{0.0F}, proxy_max_{0.0F};  // of the opaque objects, in the world
  CubeScene cube_scene_;
  ObjectPixels pixels_;
  struct Compiled {
    gl::Defines defines;
    gl::Program program;
  };
  std::map<std::pair<SurfaceKind, Use>, Compiled> programs_;
  Translucency translucency_;
  std::optional<gl::PassTimer> cost_timer_;  // a technique is made without a context
  Cost cost_;
};

}  // namespace pellucid::local_cube_maps
