#pragma once

#include <string>

#include "algorithms/technique.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace pellucid::translucent_relief {

struct BloomSettings {
  float strength = 0;    ///< 0: none
  float threshold = 1;   ///< radiance above which light blooms
  int downsampling = 4;  ///< pixels of the picture along a side of the blurred one's
  float sigma = 4;       ///< of the Gaussian, in the blurred picture's pixels
};

/// Light that spills from what is brighter than the display shows (Timonen, Sec. 4; Green and Cebenoyan 2004).
class Bloom {
 public:
  void add(const Target&, const BloomSettings&);
  std::string reload_shaders();

 private:
  void fit(int width, int height);

  gl::Program bright_, blur_, add_;
  gl::Texture first_, second_;
  gl::Framebuffer first_target_, second_target_;
  gl::VertexArray fullscreen_;
};

}  // namespace pellucid::translucent_relief
