#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "plots/pictures/close_up.hpp"
#include "sweeps/papers/paper.hpp"

/// The pictures of papers: [[pictures]] of a paper's file (sweeps/README.md). sandbox/reproduce draws them.
namespace pellucid::plots {

/// Names and values as -s takes them, in the order of the file.
using Settings = std::vector<std::pair<std::string, std::string>>;

/// One way to draw a set's scene.
struct PictureRecipe {
  std::string name;   ///< of its files
  std::string label;  ///< in the paper: "(a)"; empty for a picture of our own
  std::string technique;
  Settings settings;  ///< besides those of the set
  std::string role;   ///< one sentence: why it is here
  std::string map;    ///< which of the technique's native errors is shown by pixel too; empty for none
};

/// A figure of pictures, or the part of one that shows one view of one scene: drawn several ways and compared with one
/// reference.
struct PictureSet {
  std::string name;  ///< of its folder: "fig8"
  std::string title;
  std::string scene;          ///< a name or a path
  std::string preview_scene;  ///< the same without assets, for a preview; empty: `scene` needs none
  std::string view;           ///< empty: the scene's first
  Settings settings;          ///< of the scene, for the reference and every picture
  int width = 0, height = 0;
  std::string surfaces = "rays";  ///< of the reference: rays, raster or forward
  int samples = 1;                ///< of the reference with rays, per pixel
  int preview_samples = 1;        ///< the same for a preview; as many as `samples` where the file names none
  bool caustics = false;          ///< of the reference with rays
  std::vector<PictureRecipe> pictures;
  std::string close_up_of;  ///< the picture whose FLIP map places the close-up; empty where `close_up` says where it is
  Window close_up;          ///< its size, 0 for none, and its place unless `close_up_of` decides
  std::string close_up_why;  ///< what it shows, where its place is given
};

/// The sets of a paper, in the order of its file. Throws InputError "file:line:column: …" for the first mistake: also a
/// technique that does not exist, a setting that it lacks or that is out of range.
std::vector<PictureSet> read_pictures(const sweeps::Paper&);

}  // namespace pellucid::plots
