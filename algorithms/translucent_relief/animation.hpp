#pragma once

#include <string>
#include <vector>

#include "algorithms/scene/relief/motion.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace pellucid::translucent_relief {

/// Makes the heights and slopes of a moving layer anew on the GPU: waves, or a simulation of drops from its dry start.
class Animation {
 public:
  /// Into r32f `heights` and rg32f `slopes` of one size.
  void run(const ReliefMotion&, const gl::Texture& heights, const gl::Texture& slopes);
  /// The drops of the last run.
  std::vector<RainDrop> read_drops() const;
  std::string reload_shaders();

 private:
  gl::Program waves_, rain_, rain_surface_, slopes_;
  gl::Buffer sines_, drops_;
  gl::Texture ground_;
};

}  // namespace pellucid::translucent_relief
