#pragma once

#include <string>
#include <vector>

#include "algorithms/scene/scene.hpp"
#include "gl/objects.hpp"

namespace pellucid::distance_impostors {

struct LightMapChart;

/// The surfaces that caustics fall on: opaque instances whose surface has a chart, each with a layer of the light maps.
class Receivers {
 public:
  static constexpr int kMost = 32;
  /// Finds them, the first kMost. Returns what to warn of: objects that are left out.
  std::vector<std::string> prepare(const Scene&, int light_map_size);
  /// Follows the instances' transforms and materials.
  void place(const Scene&);

  /// For place.frag.glsl: places on the surface, and the area that the light map's unit square stands for about them.
  /// Each is drawn `copies` times, one after the other.
  void draw_places(int copies) const { draw(&Receiver::place_array, copies); }
  /// For caustic_light.frag.glsl: places and albedos.
  void draw_surfaces(int copies) const { draw(&Receiver::array, copies); }

  bool empty() const { return receivers_.empty(); }
  int count() const { return static_cast<int>(receivers_.size()); }
  /// In the order of the layers.
  std::vector<int> instances() const;

 private:
  struct Receiver {
    int instance = 0;
    gl::Buffer vertices, indices, attributes;
    gl::Buffer densities, unshaded;      // area that the unit square stands for, about each vertex
    gl::VertexArray array, place_array;  // with the colours; with the densities in their stead
    std::vector<glm::vec2> places;       // by vertex
    glm::mat3 axes{0.0F};                // of the instance, that the densities are for
    int index_count = 0;
  };
  void add(const Scene&, int instance, const LightMapChart&);
  static void measure_density(const Scene&, Receiver&, const glm::mat3& axes);
  void draw(gl::VertexArray Receiver::*array, int copies) const;

  std::vector<Receiver> receivers_;
};

}  // namespace pellucid::distance_impostors
