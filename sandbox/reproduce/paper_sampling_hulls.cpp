// Imagire et al. 2007 (references.bib: imagire2007).
#include "sandbox/reproduce/paper_list.hpp"

namespace pellucid::sandbox {
namespace {

constexpr Words kHullsSpecs[] = {"sampling_hulls_table1", "sampling_hulls_figures", "sampling_hulls_equal",
                                 "sampling_hulls_shadows", "sampling_hulls_curves"};
constexpr Words kHullsPreviews[] = {"sampling_hulls_table1_preview", "sampling_hulls_figures_preview",
                                    "sampling_hulls_equal_preview", "sampling_hulls_shadows_preview",
                                    "sampling_hulls_curves_preview"};

constexpr Words k2x4[] = {"hulls=2", "samples=4"};
constexpr Words k4x8[] = {"hulls=4", "samples=8"};
constexpr Words k4x8Floats[] = {"hulls=4", "samples=8", "coordinates=single"};
constexpr Words k128[] = {"slices=128"};
constexpr Words k32[] = {"slices=32"};
constexpr PaperPicture kFig8[] = {
    {"a_hulls_2x4", "(a)", "sampling_hulls", k2x4, "The fewest samples that the paper shows."},
    {"b_hulls_4x8", "(b)", "sampling_hulls", k4x8, "The fastest column of the paper's Table 1."},
    {"c_slices_128", "(c)", "volume_slices", k128, "The slice-based method, at the paper's count of slices."},
    {"hulls_4x8_floats", "", "sampling_hulls", k4x8Floats,
     "Not in the paper: (b) without the steps that 8 bits leave in the local-coordinates map."},
    {"slices_32", "", "volume_slices", k32,
     "Not in the paper: as many samples along a ray as (b), where slices show their stripes plainly."},
};

constexpr Words k2x8[] = {"hulls=2", "samples=8"};
constexpr Words k64[] = {"slices=64"};
constexpr Words k16[] = {"slices=16"};
constexpr PaperPicture kFig9Front[] = {
    {"a_hulls_2x8", "(a)", "sampling_hulls", k2x8, "The first of the paper's two views."},
    {"slices_64", "", "volume_slices", k64, "Not in the paper: the slices of (c) from here."},
};
constexpr PaperPicture kFig9Above[] = {
    {"b_hulls_2x8", "(b)", "sampling_hulls", k2x8, "The paper's setting, at 96 frames/s there."},
    {"c_slices_64", "(c)", "volume_slices", k64,
     "The slice-based method at the same frame rate; (d) is the part of it that shows stripes."},
    {"slices_16", "", "volume_slices", k16, "Not in the paper: as many samples along a ray as (b)."},
};

constexpr Words k4x4[] = {"hulls=4", "samples=4"};
constexpr Words k4x4Unfiltered[] = {"hulls=4", "samples=4", "filter_occlusion=false"};
constexpr Words kTime0[] = {"scene.time_s=0"};
constexpr Words kTime5[] = {"scene.time_s=5"};
constexpr PaperPicture kFig10[] = {
    {"a_hulls_4x4", "(a)", "sampling_hulls", k4x4, "The paper's setting; (e) is a part of it."},
    {"c_slices_32", "(c)", "volume_slices", k32,
     "The slice-based method at the paper's count, slower there; (d) is the part of it that shows stripes."},
    {"hulls_4x4_unfiltered", "", "sampling_hulls", k4x4Unfiltered,
     "Not in the paper: (a) without averaged occlusion rates (Eq. 4)."},
};
constexpr PaperPicture kFig10Later[] = {
    {"b_hulls_4x4", "(b)", "sampling_hulls", k4x4, "The lights have turned."},
    {"slices_32", "", "volume_slices", k32, "Not in the paper: the slices of (c) at this moment."},
};

constexpr Words k8x8[] = {"hulls=8", "samples=8"};
constexpr Words k8x8Unfiltered[] = {"hulls=8", "samples=8", "filter_occlusion=false"};
constexpr PaperPicture kFig11[] = {
    {"a_hulls_8x8", "(a)", "sampling_hulls", k8x8, "The paper's setting."},
    {"b_slices_64", "(b)", "volume_slices", k64, "The slice-based method with as many samples along a ray."},
    {"slices_16", "", "volume_slices", k16, "Not in the paper: few slices, whose stripes are plain to see."},
};
constexpr PaperPicture kFig11Shadow[] = {
    {"c_hulls_8x8", "(c)", "sampling_hulls", k8x8, "The shadow that the statue casts through the light."},
    {"d_slices_64", "(d)", "volume_slices", k64, "The slice-based method, with stripes in the shadow."},
    {"hulls_8x8_unfiltered", "", "sampling_hulls", k8x8Unfiltered,
     "Not in the paper: (c) without averaged occlusion rates (Eq. 4)."},
};

constexpr PaperPictures kHullsPictures[] = {
    {.name = "fig8",
     .title = "Fig. 8: a foggy forest",
     .scene = "fog_forest",
     .preview_scene = "",
     .view = "",
     .settings = {},
     .width = 720,
     .height = 540,
     .pictures = kFig8,
     .close_up_of = "c_slices_128",
     .close_up_width = 160,
     .close_up_height = 120},
    {.name = "fig9a",
     .title = "Fig. 9 (a): a water tank",
     .scene = "water_tank",
     .preview_scene = "water_tank_procedural",
     .view = "front",
     .settings = {},
     .width = 720,
     .height = 540,
     .pictures = kFig9Front,
     .close_up_of = "slices_64",
     .close_up_width = 160,
     .close_up_height = 120},
    {.name = "fig9",
     .title = "Fig. 9 (b) to (d): the water tank from above",
     .scene = "water_tank",
     .preview_scene = "water_tank_procedural",
     .view = "above",
     .settings = {},
     .width = 720,
     .height = 540,
     .pictures = kFig9Above,
     .close_up_of = "c_slices_64",
     .close_up_width = 160,
     .close_up_height = 120},
    {.name = "fig10",
     .title = "Fig. 10 (a), (c) to (e): a teapot in a room with two spotlights",
     .scene = "teapot_room",
     .preview_scene = "",
     .view = "front",
     .settings = kTime0,
     .width = 720,
     .height = 540,
     .pictures = kFig10,
     .close_up_of = "c_slices_32",
     .close_up_width = 160,
     .close_up_height = 120,
     .close_up_x = 360,
     .close_up_y = 250},
    {.name = "fig10b",
     .title = "Fig. 10 (b): the lights have turned",
     .scene = "teapot_room",
     .preview_scene = "",
     .view = "front",
     .settings = kTime5,
     .width = 720,
     .height = 540,
     .pictures = kFig10Later,
     .close_up_of = "slices_32",
     .close_up_width = 160,
     .close_up_height = 120,
     .close_up_x = 180,
     .close_up_y = 250},
    {.name = "fig11",
     .title = "Fig. 11 (a) and (b): a statue with a moving spotlight",
     .scene = "statue_spotlight",
     .preview_scene = "statue_spotlight_procedural",
     .view = "front",
     .settings = {},
     .width = 720,
     .height = 540,
     .pictures = kFig11,
     .close_up_of = "b_slices_64",
     .close_up_width = 160,
     .close_up_height = 120,
     .close_up_x = 400,
     .close_up_y = 240},
    {.name = "fig11c",
     .title = "Fig. 11 (c) and (d): the statue's shadow in the light",
     .scene = "statue_spotlight",
     .preview_scene = "statue_spotlight_procedural",
     .view = "shadow",
     .settings = {},
     .width = 720,
     .height = 540,
     .pictures = kFig11Shadow,
     .close_up_of = "d_slices_64",
     .close_up_width = 160,
     .close_up_height = 120,
     .close_up_x = 330,
     .close_up_y = 190},
};

}  // namespace

Paper sampling_hulls_paper() {
  return {"sampling_hulls",
          "Imagire, Johan, Tamura, Nishita 2007: Anti-aliased and real-time rendering of scenes with light "
          "scattering effects",
          "imagire2007",
          kHullsSpecs,
          kHullsPreviews,
          kHullsPictures};
}

}  // namespace pellucid::sandbox
