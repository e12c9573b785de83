// Chan and Wang 2005 (references.bib: chan2005).
#include "sandbox/reproduce/paper_list.hpp"

namespace pellucid::sandbox {
namespace {

constexpr Words kSpecs[] = {"geocube_table2", "geocube_figures", "geocube_curves"};
constexpr Words kPreviews[] = {"geocube_table2_preview", "geocube_figures_preview", "geocube_curves_preview"};

// At one sample a pixel the edges of what is seen through glass would drown the difference between the methods.
constexpr Words kSmooth[] = {"frame.supersampling=2"};
constexpr Words kOneCube[] = {"frame.supersampling=2", "cubes=1"};
constexpr Words kTwoCubes[] = {"frame.supersampling=2", "cubes=2"};
constexpr Words kTail[] = {"frame.supersampling=2", "cubes=1", "placement=hand"};
constexpr Words kTailAndHead[] = {"frame.supersampling=2", "cubes=2", "placement=hand"};
constexpr Words kLayers[] = {"frame.supersampling=2", "cubes=1", "layers=4"};
constexpr Words kNoReflection[] = {"frame.supersampling=2", "cubes=1", "reflections=0"};
constexpr Words kHighlight[] = {"cubes=1", "show=internal_reflection"};

constexpr Words kMap = "exit_error";

constexpr PaperPicture kFig1[] = {
    {"front_side", "(a)", "front_refraction", kSmooth, "Refraction where the ray enters, and nowhere else."},
    {"both_sides", "(b)", "geocube", kNoReflection, "Refraction at both sides."},
    {"internal_reflection", "", "geocube", kOneCube, "With one internal reflection."},
    {"highlighted", "(c)", "geocube", kHighlight, "Where light is totally reflected inside."},
};
constexpr PaperPicture kFig12[] = {
    {"by_hand", "", "geocube", kTailAndHead, "Two cubes as in the paper, near the tail and inside the head."},
    {"two_cubes", "", "geocube", kTwoCubes, "Two cubes, placed automatically."},
    {"screen_space", "", "screen_space_refraction", kSmooth,
     "Not in the paper: Wyman 2005, in the space of the screen."},
};
constexpr PaperPicture kFig16Head[] = {
    {"geocube", "(a)", "geocube", kOneCube, "One cube of 64×64×6 texels; (b) is the reference.", kMap},
};
constexpr PaperPicture kFig16Bunny[] = {
    {"uncovered", "(c)", "geocube", kTail,
     "One cube near the tail, which sees neither the ears nor all of the head; (d) is the reference.", kMap},
    {"by_hand", "", "geocube", kTailAndHead, "With a second one inside the head.", kMap},
    {"two_cubes", "", "geocube", kTwoCubes, "Two cubes, placed automatically.", kMap},
    {"layers", "", "geocube", kLayers, "Beyond the paper: one cube of four layers.", kMap},
};

constexpr PaperPictures figure(Words name, Words title, Words scene, std::span<const PaperPicture> pictures,
                               Words close_up_of) {
  return {.name = name,
          .title = title,
          .scene = scene,
          .preview_scene = "",
          .view = "",
          .settings = {},
          .width = 512,
          .height = 512,
          .surfaces = "rays",
          .samples = 16,
          .pictures = pictures,
          .close_up_of = close_up_of,
          .close_up_width = 128,
          .close_up_height = 128};
}

constexpr PaperPictures kPictures[] = {
    figure("fig1", "Fig. 1: a glass head", "glass_head", kFig1, "both_sides"),
    figure("fig12", "Fig. 12: a bunny that absorbs light", "glass_bunny", kFig12, "two_cubes"),
    figure("fig16a", "Fig. 16 (a) and (b): the head against ray tracing", "glass_head", kFig16Head, "geocube"),
    figure("fig16c", "Fig. 16 (c) and (d): the bunny against ray tracing", "glass_bunny", kFig16Bunny, "uncovered"),
};

}  // namespace

Paper geocube_paper() {
  return {
      "geocube",  "Chan, Wang 2005: Geocube -- GPU accelerated real-time rendering of transparency and translucency",
      "chan2005", kSpecs,
      kPreviews,  kPictures};
}

}  // namespace pellucid::sandbox
