#pragma once

#include <string>
#include <vector>

#include "algorithms/geocube/cubes.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace pellucid::geocube {

/// The texels of one layer as cube_maps.glsl reads them: six faces of (n + 2)² texels, each with a border of its
/// neighbours', so that a bilinear fetch never needs two faces. A corner that no texel has is the mean of the three
/// about it, as in GL_TEXTURE_CUBE_MAP_SEAMLESS.
std::vector<float> with_borders(const CubeGrid& grid, const std::vector<glm::vec4>& texels);

/// A CubeSet on the device.
class CubeTextures {
 public:
  CubeTextures() = default;
  /// Throws InputError when the device has not the memory.
  explicit CubeTextures(const std::string& label, const CubeSet&);
  /// Textures to units 1, 2 and 4, centres and counts to the program's uniforms.
  void bind(const gl::Program&) const;
  const CubeSet& set() const { return set_; }

 private:
  CubeSet set_;
  gl::Texture bounds_, planes_, inners_;
};

/// C* and S* as a table of size² for functions.glsl, linear between its nodes (Sec. 4).
gl::Texture make_function_table(int size);

}  // namespace pellucid::geocube
