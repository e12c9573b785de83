#pragma once

#include <string_view>

#include "algorithms/local_cube_maps/settings.hpp"
#include "algorithms/parameters.hpp"

namespace pellucid::local_cube_maps {

/// CubeLayers, or one traversal by the vertex shader where it can choose layers, else by a geometry shader.
enum class CubePass { automatic, geometry, vertex, faces };
CubeLayers layers_of(CubePass);

/// The parameters of the maps, which every technique with local cube maps has. Sections are those of Szirmay-Kalos et
/// al. 2005; a technique of another paper names the work before them.
struct MapParameters {
  int cube_size = 512;
  CubeFormat cube_format = CubeFormat::half;
  CubePass cube_pass = CubePass::automatic;
  Anchor reference_point = Anchor::object;
  float reference_x_m = 0, reference_y_m = 0, reference_z_m = 0;
  Refresh refresh = Refresh::frames;
  int refresh_frames = 1;
  float refresh_ms = 150;
  float refresh_distance_m = 0.25F;
  int mutual = 1;

  /// Where the paper speaks of each.
  struct Citations {
    std::string_view movement, anchor, format, preparation;  ///< Sec. 1, 2, 3, 6
  };
  static constexpr Citations kOwn{"Sec. 1", "Sec. 2", "Sec. 3", "Sec. 6"};
  static constexpr Citations kOfAnother{"Szirmay-Kalos et al. 2005, Sec. 1", "Szirmay-Kalos et al. 2005, Sec. 2",
                                        "Szirmay-Kalos et al. 2005, Sec. 3", "Szirmay-Kalos et al. 2005, Sec. 6"};

  static constexpr void map_parameters(auto& self, auto&& visit, const Citations& cite) {
    visit(PARAM(cube_size), {.range = {64, 2048},
                             .cite = cite.preparation,
                             .doc = "width and height of a face of the cube maps",
                             .when = Change::precompute,
                             .unit = "texels"});
    visit(PARAM(cube_format), {.cite = cite.format,
                               .doc = "bits of a channel of the cube maps: 16 (half) or 32 (single)",
                               .when = Change::precompute,
                               .choices = "half|single"});
    visit(PARAM(cube_pass), {.cite = "beyond the paper",
                             .doc = "faces of a cube map chosen by a geometry shader, by the vertex shader (automatic: "
                                    "where it can), or drawn one by one",
                             .when = Change::precompute,
                             .choices = "automatic|geometry|vertex|faces"});
    visit(PARAM(reference_point), {.symbol = "o",
                                   .cite = cite.anchor,
                                   .doc = "where the maps are drawn from: each object's middle, the middle of the "
                                          "opaque objects, or a point",
                                   .when = Change::precompute,
                                   .choices = "object|scene|point"});
    visit(
        PARAM(reference_x_m),
        {.range = {-1e4, 1e4}, .cite = cite.anchor, .doc = "x of that point", .when = Change::precompute, .unit = "m"});
    visit(
        PARAM(reference_y_m),
        {.range = {-1e4, 1e4}, .cite = cite.anchor, .doc = "y of that point", .when = Change::precompute, .unit = "m"});
    visit(
        PARAM(reference_z_m),
        {.range = {-1e4, 1e4}, .cite = cite.anchor, .doc = "z of that point", .when = Change::precompute, .unit = "m"});
    visit(PARAM(refresh), {.cite = cite.preparation,
                           .doc = "draw an object's maps once, every refresh_frames frames, every refresh_ms, or when "
                                  "it has moved by refresh_distance_m",
                           .choices = "once|frames|interval|movement"});
    visit(PARAM(refresh_frames),
          {.range = {1, 100000}, .cite = cite.preparation, .doc = "frames from one drawing to the next"});
    visit(PARAM(refresh_ms),
          {.range = {0, 60000}, .cite = cite.preparation, .doc = "time from one drawing to the next", .unit = "ms"});
    visit(PARAM(refresh_distance_m), {.range = {0, 1e4},
                                      .cite = cite.movement,
                                      .doc = "movement of the reference point that calls for new maps",
                                      .unit = "m"});
    visit(PARAM(mutual),
          {.range = {0, 4},
           .cite = cite.preparation,
           .doc = "times that the other mirrors, metals and dielectrics are drawn into each one's maps"});
  }

  /// A context must be current.
  MapSettings settings(DistanceStore, int refractor_size) const;
};

/// well_formed() of a struct with MapParameters as its base, which counts as one of its members.
template <class T>
consteval bool well_formed_with_maps() {
  pellucid::detail::CheckVisitor visitor;
  const T defaults{};
  T::parameters(defaults, visitor);
  return visitor.good &&
         visitor.count == pellucid::detail::member_count<T>() - 1 + pellucid::detail::member_count<MapParameters>();
}

}  // namespace pellucid::local_cube_maps
