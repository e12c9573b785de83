#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace pellucid::gl {

/// The scene-linear Rec. 709 → display transform, through OpenColorIO. $OCIO names a config; without it, or when it is
/// empty, an embedded one is used. That has the display "sRGB" with two views: "Film", the default, is the ACES 1.0
/// rendering for a video display; "sRGB" is the bare sRGB curve without tone mapping, for figures and error images.
///
/// A config of the user's is entered through its colour space for linear Rec. 709 where it has one under a published
/// name, else through the role `aces_interchange`, else `scene_linear` is taken to be Rec. 709.
///
/// The same transform runs on the CPU (PNG output) and on the GPU (viewer) and agrees to 1e-4 of 1, or of the value
/// where that is larger. Only what
/// draws needs a GL context, and keeps its program and LUTs in the first one it ran in.
class DisplayTransform {
 public:
  /// Without names, the config's default display and view, and no look beside those that the view has. An unreadable or
  /// malformed config, or an unknown name, is an InputError that names the file and what it offers.
  explicit DisplayTransform(const std::string& display = {}, const std::string& view = {},
                            const std::string& look = {});
  ~DisplayTransform();
  DisplayTransform(DisplayTransform&&) noexcept;
  DisplayTransform& operator=(DisplayTransform&&) noexcept;

  /// In place over interleaved RGB or RGBA; alpha is kept. The result is display-encoded, not clamped.
  void apply(std::span<float> pixels, int channels) const;

  /// Draws `source` (scene-linear RGB) times 2^exposure_ev as a full-screen triangle into the bound framebuffer, with
  /// alpha 1; depth test, blending, culling and scissor are off meanwhile.
  void draw(const Texture& source, float exposure_ev) const;

  /// A program that shows pictures its own way: `fragment` calls `vec4 ocio_display(vec4 scene_linear)`, whose text is
  /// put behind it, and includes "gl/display/lut_sampling.glsl" at its end. Units from 4 on are the LUTs'; bind_luts()
  /// binds them.
  Program program(const std::string& label, const Stage& vertex, const Stage& fragment, const Defines& = {}) const;
  void bind_luts() const;

  const std::string& display() const;
  const std::string& view() const;
  const std::string& look() const;  ///< empty: none
  /// Every (display, view) pair of the config.
  std::vector<std::pair<std::string, std::string>> views() const;
  std::vector<std::string> looks() const;  ///< of the config; the embedded one has none

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Takes the warnings that OpenColorIO would print by itself, each as one line: "OpenColorIO: At line 6, unknown key
/// …".
void on_display_warning(std::function<void(const std::string&)> tell);

}  // namespace pellucid::gl
