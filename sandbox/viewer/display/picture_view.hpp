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
};

/// A rectangle in framebuffer pixels, from the top left.
struct Region {
  int x = 0, y = 0, width = 1, height = 1;
};

/// Which part of the picture is seen, how large.
struct Zoom {
  float scale = 1;          ///< window pixels per picture pixel
  float left = 0, top = 0;  ///< the picture pixel at the region's top left corner
  bool fitted = true;       ///< follows the region: 1:1 where the picture has room, else as large as it goes
  void fit(const Region&, int width, int height, CompareMode);
  /// Zooms by `factor`, keeping what lies under (x, y) [pixels from the region's corner].
  void about(float x, float y, float factor);
};

/// Draws pictures into the window: compose, display transform, warnings.
class PictureView {
 public:
  PictureView();
  void set_a(const Image& image) { upload(image, a_, "picture A"); }
  void set_b(const Image& image) { upload(image, b_, "picture B"); }
  /// Throws InputError for a display, view or look that the config lacks; the last transform then stays.
  void set_transform(const std::string& display, const std::string& view, const std::string& look);
  const gl::DisplayTransform& transform() const { return *transform_; }
  void draw(const DisplaySettings&, const Region&, const Zoom&, int framebuffer_height);
  void draw_layer(const gl::Texture& layer) const;  ///< over the whole viewport
  std::string reload_shaders();

 private:
  static void upload(const Image&, gl::Texture&, const char* label);
  void set_viewport(const Region&, int framebuffer_height) const;
  gl::Texture a_, b_, ramp_, composed_;
  gl::Framebuffer composed_framebuffer_;
  gl::Program compose_, overlay_, layer_;
  gl::VertexArray triangle_;
  std::optional<gl::DisplayTransform> transform_;
};

}  // namespace pellucid::sandbox
