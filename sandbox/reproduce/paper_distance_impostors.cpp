// Szirmay-Kalos et al. 2005 (references.bib: szirmaykalos2005).
#include "sandbox/reproduce/paper_list.hpp"

namespace pellucid::sandbox {
namespace {

constexpr Words kSpecs[] = {"distance_impostors_figures", "distance_impostors_scenes", "distance_impostors_curves"};
constexpr Words kPreviews[] = {"distance_impostors_figures_preview", "distance_impostors_scenes_preview",
                               "distance_impostors_curves_preview"};

// The reference point stays in the middle of the room and its map is drawn once, as in the paper's test application.
constexpr Words kClassical[] = {"reference_point=scene", "refresh=once"};
constexpr Words kBox[] = {"reference_point=scene", "refresh=once", "parallax=box"};
constexpr Words kNiter0[] = {"reference_point=scene", "refresh=once", "iterations=0"};
constexpr Words kNiter1[] = {"reference_point=scene", "refresh=once", "iterations=1"};
constexpr Words kNiter3[] = {"reference_point=scene", "refresh=once", "iterations=3"};
constexpr Words kNiter8[] = {"reference_point=scene", "refresh=once", "iterations=8"};
constexpr Words kLinear[] = {"reference_point=scene", "refresh=once", "scheme=linear", "iterations=8"};

constexpr PaperPicture kFig5[] = {
    {"classical", "classical", "environment_map", kClassical, "The map of the room's middle, read by direction alone."},
    {"niter_0", "localized", "distance_impostors", kNiter0, "The second guess, without iteration."},
    {"niter_1", "localized", "distance_impostors", kNiter1, "One iteration, which mends the corners."},
    {"box", "", "environment_map", kBox,
     "Not in the paper's figure: Bjorke's box, which is the room itself here and so the best that the map allows."},
};
constexpr Words kSteps[] = {"reference_point=scene", "refresh=once", "scheme=linear_false_position", "linear_steps=8",
                            "iterations=2"};
constexpr PaperPicture kFig6[] = {
    {"classical", "classical", "environment_map", kClassical, "The map of the room's middle, read by direction alone."},
    {"niter_0", "localized", "distance_impostors", kNiter0, "The second guess, without iteration."},
    {"niter_3", "localized", "distance_impostors", kNiter3,
     "Three iterations; some rays take the wall behind the box."},
    {"niter_8", "", "distance_impostors", kNiter8, "Not in the paper: more iterations do not find it either."},
    {"steps", "", "distance_impostors", kSteps,
     "Not in the paper: 8 linear steps before 2 iterations take the first surface on most rays."},
    {"linear", "", "distance_impostors", kLinear,
     "Not in the paper: a search from the near end takes the first surface on the ray, not another."},
};
constexpr Words kSingle[] = {"reference_point=scene", "refresh=once", "bounces=1", "iterations=1"};
constexpr Words kDouble0[] = {"reference_point=scene", "refresh=once", "bounces=2", "iterations=0"};
constexpr Words kDouble1[] = {"reference_point=scene", "refresh=once", "bounces=2", "iterations=1"};
constexpr PaperPicture kFig7[] = {
    {"classical", "classical", "environment_map", kClassical, "One refraction, read by direction alone."},
    {"single", "single", "distance_impostors", kSingle, "One refraction, localized."},
    {"double_niter_0", "double", "distance_impostors", kDouble0, "Both refractions, without iteration."},
    {"double_niter_1", "double", "distance_impostors", kDouble1, "Both refractions, one iteration."},
};

constexpr Words kMiddle[] = {"scene.ball_x=0", "scene.ball_z=-2.6"};
constexpr Words kOffCentre[] = {"scene.ball_x=1.6", "scene.ball_z=-2.6"};
constexpr Words kCorner[] = {"scene.ball_x=2.7", "scene.ball_z=-2.6"};

// A set of the paper's 700×700 against ray tracing.
constexpr PaperPictures traced(Words name, Words title, Words scene, std::span<const PaperPicture> pictures,
                               Words close_up_of, int close_up) {
  return {.name = name,
          .title = title,
          .scene = scene,
          .preview_scene = "",
          .view = "",
          .settings = {},
          .width = 700,
          .height = 700,
          .surfaces = "rays",
          .pictures = pictures,
          .close_up_of = close_up_of,
          .close_up_width = close_up,
          .close_up_height = close_up};
}

constexpr PaperPictures fig5(Words name, Words title, std::span<const Words> settings) {
  PaperPictures set = traced(name, title, "mirror_room", kFig5, "niter_0", 140);
  set.settings = settings;
  return set;
}

constexpr Words kCaustics[] = {"caustics=true"};
constexpr Words kNoCaustics[] = {"caustics=false"};
constexpr Words kOnce[] = {"refresh=once"};
constexpr Words kGame[] = {"cube_size=256", "refresh=once"};
constexpr PaperPicture kFig10[] = {
    {"caustics", "", "distance_impostors", kCaustics, "Photon hits of 64×64 texels, splatted into light maps."},
    {"no_caustics", "", "distance_impostors", kNoCaustics, "Not in the paper: the shadow alone."},
};
constexpr PaperPicture kFig12[] = {
    {"impostors", "", "distance_impostors", kOnce, "With distance impostors."},
    {"classical", "", "environment_map", kOnce, "Not in the paper: classical environment mapping."},
};
constexpr PaperPicture kGamePictures[] = {
    {"impostors", "", "distance_impostors", kGame, "The game's cubes of 256 texels."},
    {"classical", "", "environment_map", kGame, "Not in the paper: classical environment mapping."},
};

constexpr PaperPictures scene(Words name, Words title, Words file, Words preview, Words view, bool caustics,
                              std::span<const PaperPicture> pictures) {
  PaperPictures set = traced(name, title, file, pictures, pictures[0].name, 160);
  set.preview_scene = preview;
  set.view = view;
  set.caustics = caustics;
  return set;
}

constexpr PaperPictures kPictures[] = {
    fig5("fig5_middle", "Fig. 5: a mirror ball before the middle of the back wall", kMiddle),
    fig5("fig5_off_centre", "Fig. 5: off-centre", kOffCentre),
    fig5("fig5_corner", "Fig. 5: in a corner", kCorner),
    traced("fig6", "Fig. 6: a box hides a part of the room from the reference point", "mirror_room_box", kFig6,
           "niter_3", 140),
    traced("fig7", "Fig. 7: a refracting ball, n = 1.1", "glass_room", kFig7, "double_niter_0", 160),
    scene("fig10", "Fig. 10: the caustic of a glass ball", "glass_caustic", "", "front", true, kFig10),
    scene("fig11", "Fig. 11: the caustic seen through the ball", "glass_caustic", "", "through", true, kFig10),
    scene("fig12_skull", "Fig. 12: a glass skull", "glass_skull", "glass_skull_procedural", "", false, kFig12),
    scene("fig12_teapot", "Fig. 12: an aluminium teapot", "metal_teapot", "", "", false, kFig12),
    scene("fig13", "Fig. 13: a reflective box among stones", "mirror_box_stones", "", "", false, kGamePictures),
    scene("fig14", "Fig. 14: a statue in reflective armour", "armour_hall", "armour_hall_procedural", "", false,
          kGamePictures),
    scene("fig15", "Fig. 15: reflective and refractive balls", "spheres_hall", "", "", false, kGamePictures),
};

}  // namespace

Paper distance_impostors_paper() {
  return {"distance_impostors",
          "Szirmay-Kalos, Aszódi, Lazányi, Premecz 2005: Approximate ray-tracing on the GPU with distance impostors",
          "szirmaykalos2005",
          kSpecs,
          kPreviews,
          kPictures};
}

}  // namespace pellucid::sandbox
