#include "algorithms/local_cube_maps/map_parameters.hpp"

namespace pellucid::local_cube_maps {

CubeLayers layers_of(CubePass pass) {
  switch (pass) {
    case CubePass::automatic:
      return vertex_shader_chooses_layers() ? CubeLayers::vertex : CubeLayers::geometry;
    case CubePass::geometry:
      return CubeLayers::geometry;
    case CubePass::vertex:
      return CubeLayers::vertex;
    case CubePass::faces:
      break;
  }
  return CubeLayers::faces;
}

MapSettings MapParameters::settings(DistanceStore store, int refractor_size) const {
  return {.cube_size = cube_size,
          .format = cube_format,
          .store = store,
          .layers = layers_of(cube_pass),
          .anchor = reference_point,
          .anchor_point = {reference_x_m, reference_y_m, reference_z_m},
          .refresh = refresh,
          .refresh_frames = refresh_frames,
          .refresh_ms = refresh_ms,
          .refresh_distance_m = refresh_distance_m,
          .mutual = mutual,
          .refractor_size = refractor_size};
}

}  // namespace pellucid::local_cube_maps
