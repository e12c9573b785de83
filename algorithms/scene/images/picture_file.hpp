#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "algorithms/scene/images/image.hpp"

namespace pellucid {

/// A rectangle of pixels; both corners belong to it.
struct PixelWindow {
  int min_x = 0, min_y = 0, max_x = 0, max_y = 0;
  bool operator==(const PixelWindow&) const = default;
};

/// A PNG's statements about its colours.
struct PngColor {
  std::optional<double> gamma;   ///< gAMA: the exponent by which light was encoded (1: not at all)
  bool srgb = false;             ///< an sRGB chunk
  bool other_primaries = false;  ///< a cHRM chunk that is not Rec. 709's
  std::string icc_profile;       ///< the name of an embedded profile
};

/// An image file with what it says of its pixels. The picture is an EXR's display window: pixels outside of what is
/// stored (the data window) are 0, and what is stored beyond it is left away; layers are of the same size.
struct PictureFile : ImageFile {
  std::vector<std::string> layer_names;                                      ///< all that the file has, read or not
  PixelWindow data_window, display_window;                                   ///< of the picture
  double pixel_aspect = 1;                                                   ///< a pixel's width over its height
  enum class Envmap { unstated, lat_long, cube } envmap = Envmap::unstated;  ///< an EXR's attribute of that name
  std::optional<PngColor> png;                                               ///< set for PNG
  std::vector<std::string> notes;  ///< what reading changed or passed over, a sentence each
};

/// "64x48 pixels", and where that is not the whole story both windows.
std::string size_text(const PictureFile&);

/// Tells by its name whether a layer is read beside the picture.
using LayerFilter = std::function<bool(const std::string& layer)>;
bool every_layer(const std::string&);
bool no_layer(const std::string&);

/// read_image() with all that the file says. The picture is the first part that has R, G and B, else Y, else the only
/// layer of R, G and B; deep parts are passed over. An EXR whose header names other primaries than Rec. 709's is
/// converted (chromaticities.hpp); PNG stays as encoded. Throws as read_image() does.
PictureFile read_picture(const std::filesystem::path&, const LayerFilter& wanted = every_layer);

/// The fewest bits that hold every value of the image as it is: half for a frame that was blended in 16-bit floats.
ExrPixel exact_pixel(const Image&);

/// How many pixels have a colour at 65504 or beyond it, the most that a 16-bit float holds.
std::size_t saturated_pixels(const Image&);

/// Brings a PNG whose gAMA chunk says that its values are no sRGB to sRGB's encoding, and notes it, or what else its
/// header says and is not followed. W3C PNG (third edition), 4.3 and 11.3.2.
void encode_as_srgb(PictureFile&);

}  // namespace pellucid
