#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "algorithms/parameters.hpp"
#include "algorithms/scene/images/image.hpp"
#include "algorithms/scene/scene.hpp"
#include "gl/objects.hpp"
#include "gl/timer.hpp"

namespace pellucid {

class ForwardPass;

/// The target of a technique: scene-linear RGBA and depth, of one size. Alpha is the transmittance to the background
/// of what was blended over it.
struct Target {
  const gl::Texture& color;
  const gl::Texture& depth;
  const gl::Framebuffer& framebuffer;
};

/// One of a technique's errors by pixel.
struct NativeMap {
  std::string name;  ///< snake_case; native_errors() gives its `_mean` and the like, for 0 or 1 its `_share`
  std::string unit;  ///< "diagonals", "deg", "steps"; empty for 0 or 1
  std::string doc;   ///< one line, no full stop
  Image values;      ///< one channel; NaN where the pixel shows no object of the technique's, or the error has no value
  /// For a map of classes, the names of 0, 1, … in snake_case: a sweep sums up the picture's error for each.
  std::vector<std::string> classes{};
};

/// A rendering technique. A context must be current for every call but parameters().
class Technique {
 public:
  virtual ~Technique() = default;
  virtual ParameterRef parameters() = 0;
  /// Precomputation, timed and reported apart. Called once before the first frame, and again when a
  /// Change::precompute parameter, its own or the scene's, changed. Throws InputError when the scene lacks what the
  /// technique needs.
  virtual void prepare(const Scene&) = 0;
  /// Draws one frame over what it clears itself; opaque objects come from `forward`. Passes are timed by name.
  virtual void render(const Scene&, const Camera&, ForwardPass& forward, const Target&, gl::PassTimer&) = 0;
  /// Errors that the technique can tell of itself (miss rate, exit distance); empty when there are none.
  virtual void native_errors(nlohmann::json&) const {}
  /// The same of the last frame by pixel, from the one computation; empty before the first frame, and from techniques
  /// whose TechniqueInfo does not promise `maps`.
  virtual std::vector<NativeMap> native_maps() const { return {}; }
  /// Recompiles its shaders from the current sources; returns the compiler's words, empty when all is well.
  virtual std::string reload_shaders() = 0;
};

struct TechniqueInfo {
  std::string_view name;  ///< snake_case
  std::string_view title;
  std::string_view citation;  ///< key in references.bib
  bool baseline = false;
  std::string_view doc;  ///< one line
  const ParameterTable& (*table)() = nullptr;
  std::unique_ptr<Technique> (*make)() = nullptr;
  bool interfaces = false;  ///< draws mirrors, metals and dielectrics; the others refuse a scene that has some
  bool maps = false;        ///< tells its errors by pixel: Technique::native_maps()
  bool classes = false;     ///< one of these is a map of classes
  bool reliefs = false;     ///< draws height fields under meshes; the others refuse a scene that has some
};

/// Every technique, in registry.cpp's order.
std::span<const TechniqueInfo> techniques();
/// Throws InputError with the nearest name.
const TechniqueInfo& find_technique(std::string_view name);

}  // namespace pellucid
