#include "algorithms/raster/mirror.hpp"

namespace pellucid {

void set_mirror(const gl::Program& program, const Material& material) {
  program.set("reflectance", material.reflectance);
  program.set("metal", material.kind == SurfaceKind::metal);
  program.set("metal_n", material.metal_n);
  program.set("metal_k", material.metal_k);
}

}  // namespace pellucid
