#include "plots/row_figures.hpp"

namespace pellucid::plots {

const std::vector<RowFigure>& row_figures() {
  // Szirmay-Kalos et al. 2005 (references.bib: szirmaykalos2005).
  static const std::string kImpostors = "distance_impostors_curves";
  static const std::vector<RowFigure> kAll{
      {{"distance_impostors.iterations", "Perceived error over iterations",
        "mean FLIP on the mirror over NITER, a line for each scheme and scene", kImpostors},
       {.x = "iterations",
        .y = "flip_mean_mask",
        .series = {"scheme", "scene"},
        .log_y = true,
        .conditions = {{"block", "iterations"}}}},
      {{"distance_impostors.hit_error", "Error of the hit point over iterations",
        "mean distance from the ray-traced hit over NITER, a line for each scheme and scene", kImpostors},
       {.x = "iterations",
        .y = "hit_error_m_mean",
        .series = {"scheme", "scene"},
        .log_y = true,
        .conditions = {{"block", "iterations"}}}},
      {{"distance_impostors.time", "Frame time over iterations",
        "time of a frame over NITER, a line for each scheme and scene", kImpostors},
       {.x = "iterations",
        .y = "frame_ms_median",
        .series = {"scheme", "scene"},
        .conditions = {{"block", "iterations"}}}},
      {{"distance_impostors.cube_size", "Perceived error over the size of the cube map",
        "mean FLIP on the mirror over the texels along a face, two iterations", kImpostors},
       {.x = "cube_size",
        .y = "flip_mean_mask",
        .log_x = true,
        .log_y = true,
        .conditions = {{"block", "cube_size"}, {"distance", "texture"}}}},
      {{"distance_impostors.distance", "Distance in the alpha channel or in a texture of its own",
        "time of a frame over the texels along a face, a line for each place of the distance", kImpostors},
       {.x = "cube_size",
        .y = "frame_ms_median",
        .series = {"distance"},
        .log_x = true,
        .conditions = {{"block", "cube_size"}}}},
      {{"distance_impostors.refresh", "Amortised cost of drawing the maps again",
        "mean time of a frame over the frames from one drawing of the maps to the next", kImpostors},
       {.x = "refresh_frames",
        .y = "frame_ms_mean",
        .series = {"cube_size"},
        .log_x = true,
        .conditions = {{"block", "refresh"}}}},
  };
  return kAll;
}

}  // namespace pellucid::plots
