#pragma once

#include <span>
#include <string_view>

/// The papers that are modules of the program, and what of each can be made again. One entry more is one paper more:
/// `pellucid list papers` and `pellucid reproduce` both read this list.
namespace pellucid::sandbox {

/// A picture of a paper's figure.
struct PaperPicture {
  std::string_view name;   ///< of its files
  std::string_view label;  ///< in the paper: "(a)"; empty for a picture of our own
  std::string_view technique;
  std::span<const std::string_view> settings;  ///< name=value, besides those of the set
  std::string_view role;                       ///< one sentence: why it is here
  std::string_view map{};  ///< which of the technique's errors by pixel is shown too (Technique::native_maps)
};

/// A figure of pictures, or the part of one that shows one view of one scene: drawn several ways and compared with one
/// reference.
struct PaperPictures {
  std::string_view name;  ///< of its folder: "fig8"
  std::string_view title;
  std::string_view scene;
  std::string_view preview_scene;              ///< the same without assets, for a preview; empty: `scene` needs none
  std::string_view view;                       ///< empty: the scene's first
  std::span<const std::string_view> settings;  ///< name=value of the scene, for the reference and every picture
  int width = 0, height = 0;
  std::string_view surfaces = "forward";  ///< of the reference; "rays" where mirrors, metals or dielectrics stand
  int samples = 1;                        ///< of the reference with rays, in a pixel
  bool caustics = false;                  ///< of the reference with rays
  std::span<const PaperPicture> pictures{};
  /// The picture whose FLIP map places the close-up, and how large a window is enlarged.
  std::string_view close_up_of;
  int close_up_width = 0, close_up_height = 0;
  /// Where the window lies instead, from the top left corner: for a part that is not the worst.
  int close_up_x = -1, close_up_y = -1;
};

struct Paper {
  std::string_view name;  ///< snake_case, as in the module's folder
  std::string_view title;
  std::string_view reference;                       ///< key in references.bib
  std::span<const std::string_view> specs;          ///< built-in sweeps (sweeps/papers)
  std::span<const std::string_view> preview_specs;  ///< the same in minutes
  std::span<const PaperPictures> pictures;
  // Its tables and figures are those of sweeps/tables/tables.hpp and plots/figures/figures.hpp whose names begin with
  // "NAME.".
};

std::span<const Paper> papers();
/// Throws InputError with the nearest name. `also`: names that the caller takes besides ("all").
const Paper& find_paper(std::string_view name, std::span<const std::string_view> also = {});

}  // namespace pellucid::sandbox
