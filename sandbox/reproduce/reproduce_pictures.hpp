#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "plots/pictures/picture_sets.hpp"

namespace pellucid::sandbox {

/// One picture of a set, as drawn. Paths are relative to the folder that draw_pictures() was given.
struct DrawnPicture {
  std::string name;
  std::string label, role;    ///< of PictureRecipe
  std::string technique;      ///< empty for the reference
  std::string settings_text;  ///< "volume_slices, slices 64"; empty for the reference
  std::string exr, png;
  std::string map_exr, map_png;        ///< FLIP against the reference; empty for the reference itself
  std::string native_exr, native_png;  ///< the technique's own error by pixel; empty where the paper asks for none
  double native_mean = 0, native_max = 0;
  std::string close_png, stretched_png;   ///< the window of the close-up, enlarged; with stretched contrast
  std::map<std::string, double> metrics;  ///< flip_mean, flip_max, rmse; empty for the reference
  std::string repeat;                     ///< a command line that draws it alone
  std::string repeat_map;                 ///< and one that compares it
  std::string device, driver, commit;     ///< of the file
  bool kept = false;                      ///< it was there already
};

struct DrawnPictures {
  std::string name, title;
  std::string scene, scene_title, stand_in, view;
  std::string settings_text;  ///< "scene.time_s 5"; empty when the scene is as it is
  int width = 0, height = 0;
  std::string surfaces;  ///< of the reference: rays, raster or forward
  DrawnPicture reference;
  std::string exactness;               ///< of the reference, as sweeps::reference_exactness() puts it
  double unconverged_share = 0;        ///< of its pixels
  std::vector<DrawnPicture> pictures;  ///< in the order of the paper
  plots::Window close_up;              ///< empty where the set has none
  std::string close_up_of;             ///< label or name of the picture that placed it; empty: it was chosen by hand
  std::string close_up_why;            ///< what it shows then
  int enlarged = 0;                    ///< factor of the close-up
  double map_scale = 0;                ///< the FLIP that the brightest colour of the maps stands for
  double native_scale = 0;             ///< the same of the techniques' own errors; 0 without any
  std::string native_name, native_doc, native_unit;
};

struct PictureOptions {
  std::filesystem::path folder;  ///< gets the files; made when missing
  std::optional<int> device;
  bool preview = false;                         ///< of the set's preview_scene, at half its width and height
  std::string made_on;                          ///< keep only files of this device; empty: of any
  std::function<void(const std::string&)> say;  ///< what is being done, one line
};

/// Draws the pictures that the folder lacks, each in a process of its own, and everything that is derived from them. A
/// file is kept when its recipe, scene, commit and device are those asked for.
DrawnPictures draw_pictures(const plots::PictureSet&, const PictureOptions&);

}  // namespace pellucid::sandbox
