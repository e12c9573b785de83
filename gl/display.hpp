#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gl/objects.hpp"

namespace pellucid::gl {

/// The scene-linear Rec. 709 → display transform, through OpenColorIO. $OCIO names a config; without it an embedded
/// one. The same transform runs on the CPU (PNG output) and on the GPU (viewer) and agrees to 1e-4.
class DisplayTransform {
 public:
  /// Without names, the config's default display and view. An unreadable or malformed config, or an unknown name, is an
  /// InputError that names the file and what it offers.
  explicit DisplayTransform(const std::string& display = {}, const std::string& view = {});
  ~DisplayTransform();
  DisplayTransform(DisplayTransform&&) noexcept;
  DisplayTransform& operator=(DisplayTransform&&) noexcept;

  /// In place over interleaved RGB or RGBA; alpha is kept. The result is display-encoded, not clamped.
  void apply(std::span<float> pixels, int channels) const;

  /// Draws `source` (scene-linear RGB) as a full-screen triangle into the bound framebuffer.
  void draw(const Texture& source, float exposure_ev) const;

  const std::string& display() const;
  const std::string& view() const;
  /// Every (display, view) pair of the config.
  std::vector<std::pair<std::string, std::string>> views() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pellucid::gl
