#pragma once

#include <optional>
#include <string>

#include "algorithms/scene/images/image.hpp"
#include "gl/display/display.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace pellucid::sandbox {

enum class CompareMode { a, b, side_by_side, wipe, difference };

/// How pictures are shown; none of it changes a picture.
struct DisplaySettings {
  CompareMode mode = CompareMode::a;
  float wipe = 0.5F;
  float gain = 1;
  int channel = -1;  ///< 0 red … 3 alpha; -1 all
  float exposure_ev = 0;
  bool warn = false, false_color = false;
  bool encoded = false;  ///< the pictures hold display-encoded colours: maps of errors
  bool operator==(const DisplaySettings&) const = default;
};

/// A rectangle in framebuffer pixels, from the top left.
struct Region {
  int x = 0, y = 0, width = 1, height = 1;
  bool operator==(const Region&) const = default;
};

/// Which part of the picture is seen, how large.
struct Zoom {
  float scale = 1;          ///< window pixels per picture pixel
  float left = 0, top = 0;  ///< the picture pixel at the region's top left corner
  bool fitted = true;       ///< follows the region: 1:1 where the picture has room, else as large as it goes
  bool operator==(const Zoom&) const = default;
  void fit(const Region&, int width, int height, CompareMode);
  /// Zooms by `factor`, keeping what lies under (x, y) [pixels from the region's corner].
  void about(float x, float y, float factor);
};

/// Draws pictures as the display shows them, and the window of one and the panel.
class PictureView {
 public:
  PictureView();
  void set_a(const Image& image) { upload(image, a_, "picture A"); }
  void set_b(const Image& image) { upload(image, b_, "picture B"); }
  /// Throws InputError for a display, view or look that the config lacks; the last transform then stays.
  void set_transform(const std::string& display, const std::string& view, const std::string& look);
  const gl::DisplayTransform& transform() const { return *transform_; }
  /// Draws the pictures at the region's size, unless nothing has changed since the last call.
  void draw(const DisplaySettings&, const Region&, const Zoom&);
  /// Into the bound framebuffer, which has the layer's size: what draw() left, with `layer` over it.
  void show(const Region&, const gl::Texture& layer) const;
  std::string reload_shaders();

 private:
  void upload(const Image&, gl::Texture&, const char* label);
  const gl::Program& program_for(const DisplaySettings&) const;
  gl::Texture a_, b_, ramp_, displayed_;
  gl::Framebuffer displayed_framebuffer_;
  struct Drawn {
    DisplaySettings settings;
    Region region;
    Zoom zoom;
    bool operator==(const Drawn&) const = default;
  };
  std::optional<Drawn> drawn_;  // what is displayed; nothing when the pictures are others since
  gl::Program plain_, full_;    // the first for one picture as it is
  gl::Program window_;
  gl::VertexArray triangle_;
  std::optional<gl::DisplayTransform> transform_;
};

}  // namespace pellucid::sandbox
