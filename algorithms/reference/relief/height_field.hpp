#pragma once

#include <optional>

#include <glm/glm.hpp>

#include "algorithms/scene/relief/relief.hpp"

/// Exact rays against height fields that are bilinear between texel centres, in double precision.
namespace pellucid {

/// A ray in the frame of a point of the mesh: x along u, y along v, z along the normal; metres.
struct ReliefRay {
  glm::dvec3 origin{0.0}, direction{0.0, 0.0, -1.0};  ///< unit
  glm::dvec2 uv{0.0};                                 ///< the mesh's, at the frame's origin
  glm::dvec2 uv_per_metre{1.0};

  glm::dvec3 at(double t) const { return origin + t * direction; }
  glm::dvec2 uv_at(double t) const { return uv + glm::dvec2(at(t)) * uv_per_metre; }
};

/// Keeps the layer's address.
class HeightField {
 public:
  HeightField(const ReliefLayer&, const glm::dvec2& tiling);

  double height_m(const glm::dvec2& mesh_uv) const;
  /// Unit, for shading: the normal map's, or that of the slopes that the techniques read.
  glm::dvec3 normal(const glm::dvec2& mesh_uv, const glm::dvec2& uv_per_metre) const;
  /// Scene-linear, 1 without a map.
  glm::dvec3 color(const glm::dvec2& mesh_uv) const;

  /// Where a ray that begins at `from` on `side` of the field (1: above, −1: below), or on the field itself and goes to
  /// that side, first passes to the other side before `to`. A ray that grazes a cell of texels is solved as a
  /// quadratic, so that no ridge is too thin.
  std::optional<double> crossing(const ReliefRay&, double from, double to, double side) const;

  double low_m() const { return static_cast<double>(layer_->low_m); }
  double high_m() const { return static_cast<double>(layer_->high_m); }
  double mean_m() const;

 private:
  double texel(long x, long y) const;
  const ReliefLayer* layer_;
  glm::dvec2 tiling_;
};

/// The part of a ray from `from` on that lies in a slab of heights and, with `cut`, in [0, 1]² of the mesh's texture
/// coordinates; nothing where none does.
std::optional<glm::dvec2> clip(const ReliefRay&, double low_m, double high_m, bool cut, double from);

}  // namespace pellucid
